"""Picture of the mismatch-positions study: every estimator, one line a condition."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.evaluation.monte_carlo.plot_styles import Style, styles_of
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.mismatch_positions.runs import (
    DEFAULTS,
    DETECTOR_OFF,
    TOLD,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SYSTEM_STYLES = {
    DEFAULTS: Style("#D55E00", "o"),
    DETECTOR_OFF: Style("#999999", "x"),
    TOLD: Style("#0072B2", "|"),
}

PANELS = (
    ("range_per_bound", "range RMSE over the bound", "log", 1.0),
    ("nees_per_dimension", "NEES per dimension", "log", 1.0),
    ("surprised_percent", "confirmed rows with NEES > 20, %", "symlog", None),
    ("lost_percent", "beyond 5 bounds, %", "linear", None),
)
"""Metric, label, scale, and where it is right."""


def draw_conditions(path: Path, rows: Sequence[StudyRow]) -> Path:
    """Draw the figures of all estimators, conditions downwards.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    rows : sequence of StudyRow
        Of the study.
    """
    from matplotlib.figure import Figure

    conditions = list(dict.fromkeys(row.condition for row in rows))
    figure = Figure(figsize=(12.0, 1.5 + 0.24 * len(conditions)), layout="constrained")
    panels = figure.subplots(1, len(PANELS), sharey=True)
    for axes, (metric, label, scale, right) in zip(panels, PANELS, strict=True):
        _draw_metric(axes, rows, conditions, metric)
        axes.set_xscale(scale)
        axes.set_xlabel(label)
        axes.grid(alpha=0.3)
        if right is not None:
            axes.axvline(right, color="0.6", linewidth=1.0, zorder=0)
    panels[0].set_yticks(np.arange(len(conditions)), conditions)
    panels[0].set_ylim(len(conditions) - 0.5, -0.5)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    return path


def _draw_metric(
    axes: Axes, rows: Sequence[StudyRow], conditions: Sequence[str], metric: str
) -> None:
    for system, style in styles_of(list(SYSTEM_STYLES), SYSTEM_STYLES).items():
        own = {row.condition: row.metrics[metric] for row in rows if row.system == system}
        axes.plot(
            [own[condition] for condition in conditions],
            np.arange(len(conditions)),
            style.marker,
            color=style.colour,
            markersize=9 if style.marker == "|" else 5,
            markeredgewidth=2,
            label=system,
        )
