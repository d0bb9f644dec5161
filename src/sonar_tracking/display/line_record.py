"""Record of frequency lines: how each line moves over time, for its Doppler shift to be seen.

One panel a line, time downwards, received frequency against the line's median: a few hundredths of
a hertz of a line of hundreds, which a common axis would hide.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from sonar_tracking.display.picture_files import new_figure, save_picture
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.time import seconds

MOST_LINES = 12
"""Lines drawn, those heard most often."""

PANELS_A_ROW = 6


def line_histories(lists: Iterable[FrequencyLines], start: int) -> dict[int, FloatArray]:
    """Return the lines heard most often, by identifier.

    Parameters
    ----------
    lists : iterable of FrequencyLines
        In order of time.
    start : int
        Stamp of time zero, ns.

    Returns
    -------
    dict of int to ndarray, shape (n, 3)
        Time (s), frequency and its standard deviation (Hz).
    """
    taken: dict[int, list[tuple[float, float, float]]] = {}
    for entry in lists:
        time = seconds(entry.stamp - start)
        for row, identifier in enumerate(entry.line_id.tolist()):
            if math.isfinite(entry.frequency[row]):
                point = (time, float(entry.frequency[row]), float(entry.standard_deviation[row]))
                taken.setdefault(identifier, []).append(point)
    longest = sorted(taken, key=lambda identifier: -len(taken[identifier]))[:MOST_LINES]
    return {identifier: np.array(taken[identifier]) for identifier in sorted(longest)}


def draw_line_record(
    histories: dict[int, FloatArray], path: Path, title: str = ""
) -> tuple[Path, Path]:
    """Draw the record, and return the files written.

    Parameters
    ----------
    histories : dict of int to ndarray, shape (n, 3)
        As :func:`line_histories` gives them, s and Hz; at least one.
    path : Path
        Image file.
    title : str
        Heading.
    """
    rows = -(-len(histories) // PANELS_A_ROW)
    columns = -(-len(histories) // rows)
    figure = new_figure(1.5 + 2.1 * columns, 1.0 + 5.0 * rows)
    figure.suptitle(title, fontsize=10)
    panels = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    last = max([1.0, *(float(points[-1, 0]) for points in histories.values())])
    for axes in panels[len(histories) :]:
        axes.set_axis_off()
    for axes, (identifier, points) in zip(panels, histories.items(), strict=False):
        times, frequency, deviation = points.T
        middle = float(np.median(frequency))
        known = np.nan_to_num(deviation)
        axes.errorbar(
            frequency - middle,
            times,
            xerr=known,
            fmt=".",
            color="#0072B2",
            ecolor="#9CC4DE",
            elinewidth=0.5,
            markersize=2.5,
        )
        widest = 1.1 * float(np.percentile(np.abs(frequency - middle), 99.0)) + np.median(known)
        axes.set_xlim(-max(widest, 1e-3), max(widest, 1e-3))
        axes.axvline(0.0, color="#BBBBBB", linewidth=0.6, zorder=0)
        axes.set_title(f"line {identifier}\n{middle:.3f} Hz", fontsize=9)
        axes.tick_params(labelsize=8)
        axes.set_xlabel("difference, Hz", fontsize=8)
    panels[0].set_ylim(last, 0.0)
    for axes in panels[::columns]:
        axes.set_ylabel("time, s")
    return save_picture(figure, path)
