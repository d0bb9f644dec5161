"""Picture of a study of many conditions: every system, one line a condition."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.evaluation.monte_carlo.plot_styles import Style
from sonar_tracking.evaluation.monte_carlo.study import StudyRow

if TYPE_CHECKING:
    from matplotlib.axes import Axes


MOST_COLUMNS = 5
"""Of a legend: names of systems are long."""

LABEL_WIDTH = 22
"""Of the label below a panel, characters a line."""

FEW_DECADES = 1.7
"""A logarithmic axis of fewer has room for 2 and 5 beside the powers of ten."""


@dataclass(frozen=True)
class Panel:
    """One figure of all conditions.

    Attributes
    ----------
    metric : str
        Its name in the rows.
    label : str
        What is written below.
    scale : str
        Of its axis: linear, log or symlog.
    right : float or None
        Where it is right, marked by a line; None = nowhere in particular.
    """

    metric: str
    label: str
    scale: str = "linear"
    right: float | None = None


def draw_conditions(
    path: Path, rows: Sequence[StudyRow], panels: Sequence[Panel], styles: Mapping[str, Style]
) -> Path:
    """Draw the figures of all systems, conditions downwards.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    rows : sequence of StudyRow
        Of the study.
    panels : sequence of Panel
        Side by side.
    styles : mapping of str to Style
        By system, in the order of the legend.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    conditions = list(dict.fromkeys(row.condition for row in rows))
    figure = Figure(figsize=(12.0, 1.5 + 0.24 * len(conditions)), layout="constrained")
    drawn = figure.subplots(1, len(panels), sharey=True)
    for axes, panel in zip(drawn, panels, strict=True):
        _draw_metric(axes, rows, conditions, panel.metric, styles)
        axes.set_xscale(panel.scale)
        if panel.scale == "log":
            few = np.ptp(np.log10(axes.get_xlim())) < FEW_DECADES
            axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
            axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(textwrap.fill(panel.label, LABEL_WIDTH))
        axes.grid(alpha=0.3)
        if panel.right is not None:
            axes.axvline(panel.right, color="0.6", linewidth=1.0, zorder=0)
    drawn[0].set_yticks(np.arange(len(conditions)), conditions)
    drawn[0].set_ylim(len(conditions) - 0.5, -0.5)
    handles, labels = drawn[0].get_legend_handles_labels()
    lines = math.ceil(len(labels) / MOST_COLUMNS)
    columns = math.ceil(len(labels) / lines)
    figure.legend(handles, labels, loc="outside upper center", ncols=columns)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    return path


def _draw_metric(
    axes: Axes,
    rows: Sequence[StudyRow],
    conditions: Sequence[str],
    metric: str,
    styles: Mapping[str, Style],
) -> None:
    for system, style in styles.items():
        own = {r.condition: r.metrics.get(metric, np.nan) for r in rows if r.system == system}
        axes.plot(
            [own.get(condition, np.nan) for condition in conditions],
            np.arange(len(conditions)),
            style.marker,
            color=style.colour,
            markersize=9 if style.marker == "|" else 5,
            markeredgewidth=2,
            label=system,
        )
