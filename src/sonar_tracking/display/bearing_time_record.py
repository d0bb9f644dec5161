"""Bearing-time record: the tracks of one sensor and the truth over the beamformer's picture.

Bearing to the right, time downwards: arrival angles from broadside, or compass bearings where the
sensor measures azimuths. Behind the tracks lies the power of the conventional beamformer, each
line relative to its strongest beam, where there are snapshots.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.display.track_history import TrackHistory
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.directions.conventional_beamformer import beam_powers
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.bearings import AngleKind, ArraySnapshots
from sonar_tracking.records.time import seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes


N_BEAMS = 361
MOST_LINES = 600
"""Lines of the beamformer picture; longer bags average more snapshots into one."""

DYNAMIC_RANGE_DB = 15.0
HEADROOM_DB = 8.0
"""The strongest beam is drawn so far below white, for the lines on top to stand out."""

MOST_NAMED = 12
"""More tracks are not listed in a legend."""

TRACK_COLOURS = ("#56B4E9", "#E69F00", "#009E73", "#F0E442", "#CC79A7", "#D55E00", "#0072B2")


@dataclass(frozen=True)
class BeamPicture:
    """Power over time and bearing.

    Attributes
    ----------
    stamps : ndarray of int, shape (n_lines,)
        Begin of each line, ns.
    angles : ndarray, shape (N_BEAMS,)
        rad.
    levels_db : ndarray, shape (n_lines, N_BEAMS)
        dB, relative to the strongest beam of the line.
    """

    stamps: IntArray
    angles: FloatArray
    levels_db: FloatArray


def beam_picture(blocks: Iterable[ArraySnapshots], blocks_per_line: int) -> BeamPicture:
    """Return the beamformer picture of successive blocks.

    Parameters
    ----------
    blocks : iterable of ArraySnapshots
        In order; blocks that are not finite are left out.
    blocks_per_line : int
        Blocks averaged into one line.
    """
    angles = np.radians(np.linspace(-90.0, 90.0, N_BEAMS))
    stamps: list[int] = []
    lines: list[FloatArray] = []
    power, count = np.zeros(N_BEAMS), 0
    for block in blocks:
        if not np.isfinite(block.data).all() or not len(block.data):
            continue
        if count == 0:
            stamps.append(block.stamp)
            lines.append(power := np.zeros(N_BEAMS))
        number = wavenumber(block.center_frequency, block.sound_speed)
        power += beam_powers(block.data, block.element_positions, angles, number)
        count = (count + 1) % blocks_per_line
    powers = np.array(lines).reshape(len(lines), N_BEAMS)
    strongest = np.maximum(powers.max(axis=1, keepdims=True, initial=0.0), np.finfo(float).tiny)
    levels = 10.0 * np.log10(np.maximum(powers / strongest, 1e-12))
    return BeamPicture(np.array(stamps, np.int64), angles, levels)


def draw_bearing_time_record(
    picture: BeamPicture,
    tracks: Sequence[TrackHistory],
    truth: Sequence[TrackHistory],
    start: int,
    path: Path,
    title: str = "",
) -> None:
    """Draw a bearing-time record into an image file.

    Parameters
    ----------
    picture : BeamPicture
        Background; may have no lines.
    tracks, truth : sequence of TrackHistory
        Lines on top, all with the same kind of angle; the picture goes with arrival angles only.
    start : int
        Stamp of time zero, ns.
    path : Path
        Image file.
    title : str
        Heading.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 9), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_facecolor("black")
    last = _draw_picture(axes, picture, start) if len(picture.stamps) else 0.0
    for number, history in enumerate(tracks):
        colour = TRACK_COLOURS[number % len(TRACK_COLOURS)]
        last = max(last, _draw_line(axes, history, start, f"track {history.id}", colour, "-", 1.6))
    for number, history in enumerate(truth):
        label = "" if number else "truth"
        last = max(last, _draw_line(axes, history, start, label, "white", "--", 0.8))
    axes.set(ylim=(last or 1.0, 0.0), ylabel="time, s", title=title)
    if any(history.kind == AngleKind.AZIMUTH for history in (*tracks, *truth)):
        axes.set(xlim=(0, 360), xlabel="bearing, deg from north", xticks=range(0, 361, 45))
    else:
        axes.set(xlim=(-90, 90), xlabel="arrival angle from broadside, deg")
        axes.set_xticks(range(-90, 91, 30))
    if len(tracks) <= MOST_NAMED and axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper right", fontsize=8, facecolor="#333333", labelcolor="white")
    figure.savefig(path, dpi=120)


def _draw_line(
    axes: Axes,
    history: TrackHistory,
    start: int,
    label: str,
    colour: str,
    style: str,
    width: float,
) -> float:
    """Draw one track; return the time of its end, s."""
    times = seconds(history.stamps - start)
    axes.plot(
        history.degrees_with_gaps(),
        times,
        color=colour,
        linestyle=style,
        linewidth=width,
        label=label,
    )
    return float(times[-1])


def _draw_picture(axes: Axes, picture: BeamPicture, start: int) -> float:
    """Draw the background; return the time of its end, s."""
    times = seconds(picture.stamps - start)
    step = float(np.median(np.diff(times))) if len(times) > 1 else 1.0
    edges = np.append(times, times[-1] + step)
    degrees = np.degrees(picture.angles)
    half_beam = 0.5 * (degrees[1] - degrees[0])
    beams = np.append(degrees - half_beam, degrees[-1] + half_beam)
    image = axes.pcolormesh(
        beams, edges, picture.levels_db, cmap="bone", vmin=-DYNAMIC_RANGE_DB, vmax=HEADROOM_DB
    )
    figure = axes.figure
    bar = figure.colorbar(image, ax=axes, label="beam power, dB of the strongest", shrink=0.6)
    bar.ax.set_ylim(-DYNAMIC_RANGE_DB, 0.0)
    return float(edges[-1])
