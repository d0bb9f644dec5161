"""Stacked dots of the tracks of a recording: what their last solutions leave of the measurements.

One column a sensor's bearings or a line; time downwards, own ship's turns shaded. A right solution
stacks its dots on zero; see :mod:`sonar_tracking.display.page.stacked_dots`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.display.page.own_ship_legs import Leg
from sonar_tracking.display.page.stacked_dots import DotStack
from sonar_tracking.display.picture_files import new_figure, save_picture
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMNS_A_ROW = 6
MOST_COLUMNS = 18
MOST_OF_A_TRACK = 3
"""Columns of one track, bearings first, while others wait for a place."""

FAR = 3.0
"""Dots farther from zero are crosses, in standard deviations."""


@dataclass(frozen=True)
class TrackDots:
    """The stacks of one track.

    Attributes
    ----------
    name : str
        Of the track.
    stacks : tuple of DotStack
        Bearings, then lines.
    """

    name: str
    stacks: tuple[DotStack, ...]


def draw_stacked_dots(
    tracks: Sequence[TrackDots], legs: Sequence[Leg], start: int, path: Path, title: str = ""
) -> tuple[Path, Path]:
    """Draw the dots of tracks, and return the files written.

    Parameters
    ----------
    tracks : sequence of TrackDots
        At least one with a stack.
    legs : sequence of Leg
        Of own ship.
    start : int
        Stamp of time zero, ns.
    path : Path
        Image file.
    title : str
        Heading.
    """
    columns = _columns(tracks)
    rows = -(-len(columns) // COLUMNS_A_ROW)
    across = -(-len(columns) // rows)
    figure = new_figure(1.2 + 2.0 * across, 0.8 + 4.6 * rows)
    figure.suptitle(title, fontsize=10)
    panels = figure.subplots(rows, across, sharey=True, squeeze=False).ravel()
    begin = min(seconds(int(stack.stamps[0]) - start) for _, stack in columns)
    end = max(seconds(int(stack.stamps[-1]) - start) for _, stack in columns)
    for axes in panels[len(columns) :]:
        axes.set_axis_off()
    for axes, (name, stack) in zip(panels, columns, strict=False):
        _draw_legs(axes, legs, start)
        _draw_stack(axes, stack, start)
        axes.set_title(f"track {name}\n{stack.label}", fontsize=8)
    panels[0].set_ylim(end + 1.0, begin - 1.0)
    for axes in panels[::across]:
        axes.set_ylabel("time, s")
    return save_picture(figure, path)


def _columns(tracks: Sequence[TrackDots]) -> list[tuple[str, DotStack]]:
    """Return the columns drawn: the first of every track, then more while there is room."""
    chosen: list[tuple[int, int]] = []
    for place in range(MOST_COLUMNS):
        for index, track in enumerate(tracks):
            full = len(chosen) >= MOST_COLUMNS or place >= MOST_OF_A_TRACK
            if place < len(track.stacks) and not full:
                chosen.append((index, place))
    return [(tracks[index].name, tracks[index].stacks[place]) for index, place in sorted(chosen)]


def _draw_legs(axes: Axes, legs: Sequence[Leg], start: int) -> None:
    for leg in legs:
        if leg.turning:
            begin, end = seconds(leg.begin - start), seconds(leg.end - start)
            axes.axhspan(begin, end, color="#E3E9EF", zorder=0, linewidth=0.0)


def _draw_stack(axes: Axes, stack: DotStack, start: int) -> None:
    bearings = np.isnan(stack.frequency)
    unit = np.degrees(1.0) if bearings else 1.0
    times = seconds(stack.stamps - start)
    residual, deviation = unit * stack.residual, unit * np.nan_to_num(stack.deviation)
    usual = float(np.median(deviation))
    axes.axvspan(-2.0 * usual, 2.0 * usual, color="#0072B2", alpha=0.1, linewidth=0.0)
    axes.axvline(0.0, color="#777777", linewidth=0.7)
    near = np.abs(residual) <= FAR * deviation
    colour = "#0072B2" if bearings else "#009E73"
    axes.plot(residual[near], times[near], ".", color=colour, markersize=3.0)
    axes.plot(residual[~near], times[~near], "x", color="#B3261E", markersize=3.0, mew=0.7)
    reach = _reach(residual, usual)
    axes.set_xlim(-reach, reach)
    axes.set_xlabel("bearing, deg" if bearings else "frequency, Hz")
    axes.tick_params(labelsize=8)


def _reach(residual: FloatArray, usual: float) -> float:
    known = np.abs(residual[np.isfinite(residual)])
    most = float(np.percentile(known, 97.0)) if known.size else 0.0
    return max(1.15 * most, 4.0 * usual, 1e-6)
