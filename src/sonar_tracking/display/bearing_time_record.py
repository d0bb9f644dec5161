"""Bearing-time record of a bag: beamformer picture, tracks and truth, and a table of the tracks.

Bearing to the right, time downwards. Behind the tracks lies the power of the conventional
beamformer, each line relative to its strongest beam, where the bag holds snapshots.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.bags.bag_records import (
    BEARING_TRACKS_TYPE,
    SNAPSHOTS_TYPE,
    bearing_tracks_of,
    snapshots_of,
    topics_of_type,
)
from sonar_tracking.bags.reader import Bag, read_bag
from sonar_tracking.display.track_history import TrackHistory, track_histories, track_summary
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.conventional_beamformer import beam_powers
from sonar_tracking.passive.records import ArraySnapshots

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FloatArray = NDArray[np.float64]

N_BEAMS = 361
MOST_LINES = 600
"""Lines of the beamformer picture; longer bags average more snapshots into one."""

DYNAMIC_RANGE_DB = 15.0
HEADROOM_DB = 8.0
"""The strongest beam is drawn so far below white, for the lines on top to stand out."""

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
        Relative to the strongest beam of the line.
    """

    stamps: NDArray[np.int64]
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


def plot_bag(bag: Path | str, output: Path | str) -> tuple[Path, ...]:
    """Draw the bearing-time record of a bag, and print and write the table of its tracks.

    Parameters
    ----------
    bag : Path or str
        Bag with snapshots, tracks or both.
    output : Path or str
        Directory for ``bearing_time_record.png`` and ``tracks.txt``; made if missing.

    Returns
    -------
    tuple of Path
        Files written.

    Raises
    ------
    ConfigurationError
        If the bag cannot be read or holds neither snapshots nor bearing tracks.
    """
    from rich.console import Console

    console = Console(highlight=False, soft_wrap=True)
    opened = read_bag(bag)
    if opened.recovery:
        console.print(opened.recovery)
    rejected: list[str] = []
    picture = _picture(opened, rejected)
    tracks = _histories(opened, "output", rejected)
    truth = _histories(opened, "truth", rejected)
    if rejected:
        console.print(f"{len(rejected)} messages were left out, the first: {rejected[0]}")
    begins = [history.stamps[0] for history in (*tracks, *truth)] + list(picture.stamps[:1])
    if not begins:
        raise ConfigurationError(
            f"{opened.path} holds neither snapshots nor bearing tracks; its topics are "
            f"{', '.join(opened.topics)}."
        )
    start = int(min(begins))
    directory = Path(output)
    directory.mkdir(parents=True, exist_ok=True)
    image = directory / "bearing_time_record.png"
    draw_bearing_time_record(picture, tracks, truth, start, image)
    written = [image]
    if tracks:
        written.append(directory / "tracks.txt")
        table = track_summary(tracks, start)
        console.print(table)
        with written[-1].open("w", encoding="utf-8") as file:
            Console(file=file, width=100, highlight=False).print(table)
    for path in written:
        console.print(f"wrote {path}")
    return tuple(written)


def draw_bearing_time_record(
    picture: BeamPicture,
    tracks: Iterable[TrackHistory],
    truth: Iterable[TrackHistory],
    start: int,
    path: Path,
) -> None:
    """Draw a bearing-time record into an image file.

    Parameters
    ----------
    picture : BeamPicture
        Background; may have no lines.
    tracks, truth : iterable of TrackHistory
        Lines on top.
    start : int
        Stamp of time zero, ns.
    path : Path
        Image file.
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
    axes.set(xlim=(-90, 90), ylim=(last or 1.0, 0.0))
    axes.set(xlabel="arrival angle from broadside, deg", ylabel="time, s")
    axes.set_xticks(range(-90, 91, 30))
    if axes.get_legend_handles_labels()[0]:
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
    times = (history.stamps - start) * 1e-9
    axes.plot(
        np.degrees(history.angles_with_gaps()),
        times,
        color=colour,
        linestyle=style,
        linewidth=width,
        label=label,
    )
    return float(times[-1])


def _draw_picture(axes: Axes, picture: BeamPicture, start: int) -> float:
    """Draw the background; return the time of its end, s."""
    times = (picture.stamps - start) * 1e-9
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


def _picture(bag: Bag, rejected: list[str]) -> BeamPicture:
    """Return the picture of the first snapshot topic; without lines where there is none."""
    topics = topics_of_type(bag, SNAPSHOTS_TYPE)
    if not topics:
        return beam_picture((), 1)
    blocks_per_line = -(-bag.topics[topics[0]].message_count // MOST_LINES)
    return beam_picture(snapshots_of(bag, topics[0], rejected), blocks_per_line)


def _histories(bag: Bag, role: str, rejected: list[str]) -> tuple[TrackHistory, ...]:
    """Return the tracks of the first track topic of a role that ever were confirmed."""
    topics = topics_of_type(bag, BEARING_TRACKS_TYPE, role)
    if not topics:
        return ()
    histories = track_histories(bearing_tracks_of(bag, topics[0], rejected))
    return tuple(history for history in histories if history.confirmed)
