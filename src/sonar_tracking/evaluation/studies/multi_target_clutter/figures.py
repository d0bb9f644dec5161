"""Pictures of the multi-target-clutter study: Figs. 4 to 9 of Kim and Song (2007)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.evaluation.monte_carlo.plot_styles import Style, styles_of
from sonar_tracking.evaluation.studies.multi_target_clutter.runs import ClutterRun
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import PING_INTERVAL
from sonar_tracking.evaluation.studies.multi_target_clutter.systems import HPDA_KALMAN
from sonar_tracking.records.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


COLOURS = ("#0072B2", "#56B4E9", "#D55E00", "#E69F00", "#009E73", "#CC79A7", "#999999")
"""Okabe and Ito's palette: told apart by colour-blind readers, too."""

SYSTEM_STYLES = {HPDA_KALMAN: Style("#000000")}
"""The others get the next free ones, panel by panel."""


def draw_scene(path: Path, truth: Sequence[FloatArray]) -> Path:
    """Draw the true paths.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    truth : sequence of ndarray, shape (n_targets, 3)
        Identity, x and y at each ping, m.
    """
    figure, axes = _tactical("Paths of the targets")
    _draw_truth(axes, truth, 1.5)
    axes.legend(fontsize="small")
    return _saved(figure, path)


def draw_tracks(path: Path, run: ClutterRun, system: str) -> Path:
    """Draw the estimates of one tracker in one run over the true paths.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    run : ClutterRun
        The run.
    system : str
        Name of the tracker.
    """
    figure, axes = _tactical(f"{system}, {run.condition}, one run")
    _draw_truth(axes, run.truth, 6.0)
    estimates = np.concatenate(run.systems[system].estimates)
    axes.plot(estimates[:, 1], estimates[:, 2], "k.", markersize=1.2, label="estimates")
    axes.legend(fontsize="small")
    return _saved(figure, path)


def draw_counts(path: Path, runs: Sequence[ClutterRun], systems: Sequence[Sequence[str]]) -> Path:
    """Draw the true and the run-averaged estimated number of targets over time.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    runs : sequence of ClutterRun
        Of one environment.
    systems : sequence of sequence of str
        Trackers drawn, one panel for each group: the restless curves of some would hide others.
    """
    from matplotlib.figure import Figure

    n_panels = max(1, len(systems))
    figure = Figure(figsize=(8.5, 1.0 + 3.2 * n_panels), layout="constrained")
    panels = figure.subplots(n_panels, 1, sharex=True, squeeze=False)[:, 0]
    for axes, names in zip(panels, systems or ((),), strict=True):
        _draw_numbers(axes, runs, names)
    average = f", mean of {len(runs)} runs" if systems and len(runs) > 1 else ""
    panels[0].set_title(f"Number of targets, {runs[0].condition}{average}")
    panels[-1].set_xlabel("time (s)")
    return _saved(figure, path)


def _draw_numbers(axes: Axes, runs: Sequence[ClutterRun], names: Sequence[str]) -> None:
    from matplotlib.ticker import MaxNLocator

    times = PING_INTERVAL * np.arange(len(runs[0].true_count))
    truth = runs[0].true_count
    axes.plot(times, truth, color="0.75", linewidth=5.0, drawstyle="steps-post", label="truth")
    styles = styles_of(names, SYSTEM_STYLES)
    for index, name in enumerate(names):
        count = np.mean([run.systems[name].count for run in runs], axis=0)
        # Narrower from one to the next: curves on top of one another are all seen.
        width, style = 0.7 * (len(names) - index), styles[name]
        axes.plot(times, count, style.line, color=style.colour, linewidth=width, label=name)
    axes.set_ylabel("number of targets")
    axes.set_ylim(bottom=0.0)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", loc="upper left")


def _tactical(title: str) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.5, 6.0), layout="constrained")
    axes = figure.add_subplot()
    axes.set_aspect("equal")
    axes.set_xlabel("x, east (m)")
    axes.set_ylabel("y, north (m)")
    axes.set_title(title)
    axes.grid(alpha=0.3)
    axes.plot(0.0, 0.0, "k^", markersize=8)
    return figure, axes


def _draw_truth(axes: Axes, truth: Sequence[FloatArray], width: float) -> None:
    points = np.concatenate(truth)
    for colour, identity in zip(cycle(COLOURS), np.unique(points[:, 0])):
        own = points[points[:, 0] == identity]
        label = f"target {identity:.0f}"
        axes.plot(own[:, 1], own[:, 2], color=colour, linewidth=width, alpha=0.8, label=label)
        axes.plot(own[0, 1], own[0, 2], "o", color=colour)


def _saved(figure: Figure, path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    return path
