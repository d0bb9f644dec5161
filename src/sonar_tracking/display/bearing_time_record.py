"""Bearing-time record: the tracks of one sensor and the truth over the power of its beams.

Bearing to the right, time downwards: arrival angles from broadside, or compass bearings where the
sensor measures azimuths. Where there are snapshots or samples the same time is drawn on up to three
scales side by side: the short one shows what moves, the long ones what is weak.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.display.picture_files import loudness_colours, new_figure, save_picture
from sonar_tracking.display.track_history import TrackHistory
from sonar_tracking.display.waterfalls.beam_rows import BeamAxis, BeamRow
from sonar_tracking.display.waterfalls.bounded_rows import BoundedRows
from sonar_tracking.display.waterfalls.waterfall_cascade import SCALES, WaterfallCascade
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import AngleKind
from sonar_tracking.records.time import LAST_STAMP, seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh

PRINTED_SCALES = (0.2, *SCALES)
"""Of which the longest are drawn that have lines enough, s."""

MOST_PANELS = 3
FEWEST_LINES = 12
"""A time scale with fewer lines is not drawn beside others."""

MOST_LINES = 1200
"""Lines of one time scale; in longer recordings neighbours are integrated to one."""

DYNAMIC_RANGE_DB = 15.0
"""Drawn above the quiet beams of each line, dB."""

QUIET_SHARE = 0.3
"""Share of the beams of a line that are taken to hear noise only."""

TRACK_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#B8860B", "#56B4E9", "#8B5CF6")


class Waterfall:
    """Rows of beam power of one topic, on all time scales.

    Parameters
    ----------
    content : str
        ``narrowband`` or ``broadband``.
    """

    def __init__(self, content: str) -> None:
        self.content = content
        self.sensor_id, self.begin = "", LAST_STAMP
        self._cascade = WaterfallCascade(PRINTED_SCALES)
        self._kept = {scale: BoundedRows(MOST_LINES) for scale in PRINTED_SCALES}

    def add(self, row: BeamRow) -> None:
        """Take the next row."""
        self.sensor_id, self.begin = row.sensor_id, min(self.begin, row.begin)
        for scaled in self._cascade.add(row):
            self._kept[scaled.scale].add(scaled.row)

    def finished(self) -> Mapping[float, Sequence[BeamRow]]:
        """Complete the rows that have begun; return those of the scales to draw by scale, s."""
        for scaled in self._cascade.flush():
            self._kept[scaled.scale].add(scaled.row)
        drawn: list[float] = []
        for scale in reversed(PRINTED_SCALES):
            count = len(self._kept[scale].rows)
            # Where blocks are longer than a scale its lines are those of the next one.
            finer = not drawn or count > 1.5 * len(self._kept[drawn[-1]].rows)
            if len(drawn) < MOST_PANELS and count >= FEWEST_LINES and finer:
                drawn.append(scale)
        drawn = drawn or [scale for scale in PRINTED_SCALES[:1] if self._kept[scale].rows]
        return {scale: self._kept[scale].rows for scale in reversed(drawn)}


@dataclass(frozen=True)
class BeamPicture:
    """Rows as they are drawn.

    Attributes
    ----------
    edges : ndarray, shape (n_lines + 1,)
        Times, s.
    degrees : ndarray, shape (n_beams + 1,)
        Edges of the beams, deg from broadside.
    levels_db : ndarray, shape (n_lines, n_beams)
        dB over the quiet beams of the line; NaN = nothing was received.
    """

    edges: FloatArray
    degrees: FloatArray
    levels_db: FloatArray


def beam_picture(rows: Sequence[BeamRow], start: int) -> BeamPicture:
    """Return the picture of rows: each at its own time, gaps empty.

    Parameters
    ----------
    rows : sequence of BeamRow
        In order; those with other beams than the last one are left out.
    start : int
        Stamp of time zero, ns.
    """
    axis = rows[-1].axis
    edges: list[float] = []
    lines: list[FloatArray] = []
    nothing = np.full(axis.count, np.nan)
    for row in rows:
        begin, end = seconds(row.begin - start), seconds(row.end - start)
        if row.axis != axis or (edges and end <= edges[-1]):
            continue
        if not edges:
            edges.append(begin)
        elif begin > edges[-1] + 1e-3:
            lines.append(nothing)
            edges.append(begin)
        level = row.level_db.astype(np.float64)
        lines.append(level - np.quantile(level, QUIET_SHARE))
        edges.append(end)
    return BeamPicture(np.array(edges), np.degrees(_beam_edges(axis)), np.array(lines))


def _beam_edges(axis: BeamAxis) -> FloatArray:
    middles = np.asarray(axis.first + axis.step * (np.arange(axis.count + 1) - 0.5), np.float64)
    return np.arcsin(np.clip(middles, -1.0, 1.0)) if axis.sine else middles


def draw_bearing_time_record(
    scales: Mapping[float, Sequence[BeamRow]],
    tracks: Sequence[TrackHistory],
    truth: Sequence[TrackHistory],
    start: int,
    path: Path,
    title: str = "",
) -> tuple[Path, Path]:
    """Draw a bearing-time record, and return the files written.

    Parameters
    ----------
    scales : mapping of float to sequence of BeamRow
        Rows by time scale (s); may be empty.
    tracks, truth : sequence of TrackHistory
        Lines on top, all with the same kind of angle; beams go with arrival angles only.
    start : int
        Stamp of time zero, ns.
    path : Path
        Image file.
    title : str
        Heading.
    """
    count = max(len(scales), 1)
    figure = new_figure(1.6 + 3.4 * count if scales else 6.5, 7.5)
    panels = figure.subplots(1, count, sharey=True, squeeze=False)[0]
    figure.suptitle(title, fontsize=10)
    ends = [seconds(int(history.stamps[-1]) - start) for history in (*tracks, *truth)]
    mesh = None
    for axes, (scale, rows) in zip(panels, scales.items(), strict=False):
        mesh = _draw_beams(axes, beam_picture(rows, start))
        usual = float(np.median([row.integrated for row in rows]))
        axes.set_title(f"{max(scale, round(usual, 1)):g} s a line")
        ends.append(seconds(rows[-1].end - start))
    for axes in panels:
        _draw_tracks(axes, tracks, truth, start)
        _label_angles(axes, [history.kind for history in (*tracks, *truth)], scales)
    panels[0].set(ylim=(max([*ends, 0.0]) or 1.0, min(0.0, *ends)), ylabel="time, s")
    if mesh is not None:
        label = "power over the quiet beams, dB"
        figure.colorbar(mesh, ax=list(panels), label=label, shrink=0.5, aspect=30, pad=0.01)
    return save_picture(figure, path)


def _draw_beams(axes: Axes, picture: BeamPicture) -> QuadMesh:
    return axes.pcolormesh(
        picture.degrees,
        picture.edges,
        picture.levels_db,
        cmap=loudness_colours(),
        vmin=0.0,
        vmax=DYNAMIC_RANGE_DB,
        rasterized=True,
    )


def _draw_tracks(
    axes: Axes, tracks: Sequence[TrackHistory], truth: Sequence[TrackHistory], start: int
) -> None:
    from matplotlib.patheffects import withStroke

    rim = [withStroke(linewidth=2.6, foreground="white", alpha=0.8)]
    for history in truth:
        times = seconds(history.stamps - start)
        axes.plot(
            history.degrees_with_gaps(),
            times,
            color="black",
            linestyle=(0, (4, 3)),
            linewidth=0.7,
            path_effects=rim,
        )
    for number, history in enumerate(tracks):
        colour = TRACK_COLOURS[number % len(TRACK_COLOURS)]
        times, degrees = seconds(history.stamps - start), history.degrees_with_gaps()
        axes.plot(degrees, times, color=colour, linewidth=1.2, path_effects=rim)
        axes.annotate(
            str(history.id),
            (float(history.degrees[0]), float(times[0])),
            xytext=(3, -7),
            textcoords="offset points",
            color=colour,
            fontsize=8,
            fontweight="bold",
            path_effects=rim,
        )


def _label_angles(axes: Axes, kinds: Sequence[AngleKind], beams: object) -> None:
    if AngleKind.AZIMUTH in kinds and not beams:
        axes.set(xlim=(0, 360), xlabel="bearing, deg from north", xticks=range(0, 361, 45))
        return
    low, high = axes.get_xlim() if beams else (-90.0, 90.0)
    widest = 180 if max(-low, high) > 100.0 else 90
    axes.set(xlim=(-widest, widest), xlabel="arrival angle from broadside, deg")
    axes.set_xticks(range(-widest, widest + 1, widest // 3))
