"""Picture of the near sources: where the whole array locates them, bearing errors of sub-arrays."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.evaluation.monte_carlo.plot_styles import Style, styles_of
from sonar_tracking.evaluation.studies.room_array.near_field_rows import (
    PLANE,
    SPHERICAL,
    SPHERICAL_MUSIC,
    NearFieldResult,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STYLES = {PLANE: Style("#D55E00"), SPHERICAL: Style("#0072B2")}
_NOT_DRAWN = (SPHERICAL_MUSIC,)
"""The table compares it with the spherical fit."""


def draw_near_field(results: Sequence[NearFieldResult], path: Path) -> Path:
    """Draw the sources alone: positions by the whole array, bearing errors of the sub-arrays.

    Parameters
    ----------
    results : sequence of NearFieldResult
        Of all runs.
    path : Path
        File to write.

    Returns
    -------
    Path
        The picture.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    alone = [r for r in results if len(r.sources) == 1 and r.method not in _NOT_DRAWN]
    largest = max(r.n_elements for r in alone)
    moving = [r for r in alone if r.n_elements < largest]
    sources = sorted({r.sources[0] for r in moving})
    figure = Figure(figsize=(12.0, 6.5), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(max(len(sources), 1), 2)
    _draw_map(figure.add_subplot(grid[:, 0]), [r for r in alone if r.n_elements == largest])
    for row, source in enumerate(sources):
        axes = figure.add_subplot(grid[row, 1])
        _draw_errors(axes, [r for r in moving if r.sources == (source,)])
        axes.set_title(
            f"source {source}, {moving[0].n_elements} elements: to the bearing by the onsets",
            fontsize=9,
        )
        if row == 0:
            axes.legend(fontsize=7, loc="upper right", ncols=3)
        if row + 1 == len(sources):
            axes.set_xlabel("position of the sub-array, elements")
    figure.savefig(path, dpi=120)
    return path


def _draw_map(axes: Axes, whole: Sequence[NearFieldResult]) -> None:
    """Draw array and sources from above, the centre of the array at the origin."""
    axes.plot([-0.465, 0.465], [0.0, 0.0], color="black", linewidth=4, label="array")
    markers = {"surveyed": "s", "located": "o"}
    labels = {"surveyed": "surveyed", "located": "by the onsets of the responses"}
    for name, marker in markers.items():
        points = np.concatenate([_places(getattr(r, name)) for r in whole])
        axes.plot(
            points[:, 0], points[:, 1], marker, color="black", fillstyle="none", markersize=9,
            label=labels[name],
        )  # fmt: skip
    points = np.concatenate([_places(r.found) for r in whole if r.method == SPHERICAL])
    axes.plot(
        points[:, 0], points[:, 1], ".", color=_STYLES[SPHERICAL].colour, label=f"{SPHERICAL} waves"
    )
    plane = [r.found[0, 0, 0] for r in whole if r.method == PLANE]
    for index, angle in enumerate(plane):
        end = 0.35 * np.array([np.sin(angle), np.cos(angle)])
        axes.plot(
            [0.0, end[0]], [0.0, end[1]], color=_STYLES[PLANE].colour, linewidth=0.6, alpha=0.7,
            label=f"bearings by {PLANE} waves" if index == 0 else None,
        )  # fmt: skip
    for source, (x, y) in {r.sources[0]: _places(r.located)[0] for r in whole}.items():
        axes.annotate(str(source), (x, y), (9, -4), textcoords="offset points")
    axes.set_aspect("equal")
    axes.set_xlabel("along the array, m")
    axes.set_ylabel("away from it, m")
    axes.set_title(f"all {whole[0].n_elements} elements", fontsize=9)
    axes.legend(fontsize=7, loc="upper left")
    axes.grid(alpha=0.3)


def _places(polar: np.ndarray) -> np.ndarray:
    """Return places along and away from the array of angles and ranges (1, n, 2)."""
    angle, distance = polar[0, :, 0], polar[0, :, 1]
    return np.stack([distance * np.sin(angle), distance * np.cos(angle)], axis=-1)


def _draw_errors(axes: Axes, results: Sequence[NearFieldResult]) -> None:
    for method, style in styles_of([r.method for r in results], _STYLES).items():
        for result in [r for r in results if r.method == method]:
            error = np.degrees(result.found - result.located)[:, 0, 0]
            axes.plot(error, ".", color=style.colour, markersize=4)
        axes.plot([], [], ".", color=style.colour, label=f"{method} waves")
    first = results[0]
    survey = np.degrees(first.surveyed - first.located)[:, 0, 0]
    axes.plot(survey, color="0.4", linewidth=1, label="survey")
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_ylim(-15.0, 20.0)
    axes.set_ylabel("bearing error, deg")
    axes.grid(alpha=0.3)
