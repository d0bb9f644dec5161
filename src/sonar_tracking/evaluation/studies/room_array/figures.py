"""Pictures of the room-array study: bearings at every position of the sub-array, near sources."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.room_array.near_field_figures import draw_near_field
from sonar_tracking.evaluation.studies.room_array.near_field_rows import NearFieldResult
from sonar_tracking.evaluation.studies.room_array.rows import (
    APART_DEG,
    FROM_NOTHING,
    TOLD,
    RoomResult,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
_MARKERS = ("o", "^", "s", "D", "v")
"""Of the frequencies."""

_SHADE = "0.92"
_FILES = {TOLD: "room_array.png", FROM_NOTHING: "room_array_from_nothing.png"}


def draw_room_array(
    results: Sequence[Any], rows: Sequence[StudyRow], directory: Path
) -> tuple[Path, ...]:
    """Draw surveyed and tracked bearings of every recording, and the near sources.

    Parameters
    ----------
    results : sequence
        What the tasks returned: sequences of RoomResult or NearFieldResult.
    rows : sequence of StudyRow
        Rows of the study.
    directory : Path
        Where to write.

    Returns
    -------
    tuple of Path
        One picture for what the chain is given, one for the near sources.
    """
    flat = [result for task in results for result in task]
    recordings = [result for result in flat if isinstance(result, RoomResult)]
    directory.mkdir(parents=True, exist_ok=True)
    paths = []
    for system, name in _FILES.items():
        chosen = [result for result in recordings if result.system == system]
        if chosen:
            paths.append(_draw_system(chosen, directory / name))
    near = [result for result in flat if isinstance(result, NearFieldResult)]
    if near:
        paths.append(draw_near_field(near, directory / "room_near_field.png"))
    return tuple(paths)


def _draw_system(recordings: Sequence[RoomResult], path: Path) -> Path:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    cases = sorted({result.sources for result in recordings}, key=lambda case: (len(case), case))
    markers = dict(zip(sorted({r.frequency for r in recordings}), cycle(_MARKERS), strict=False))
    n_columns = min(4, len(cases))
    n_rows = -(-len(cases) // n_columns)
    figure = Figure(figsize=(2.0 + 3.2 * n_columns, 1.4 + 2.8 * n_rows), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(n_rows, n_columns, sharex=True, sharey=True, squeeze=False)
    for axes in grid.ravel()[len(cases) :]:
        axes.remove()
    for place, (axes, case) in enumerate(zip(grid.ravel(), cases, strict=False)):
        _draw_case(axes, [result for result in recordings if result.sources == case], markers)
        lowest = place + n_columns >= len(cases)
        axes.tick_params(labelbottom=lowest)
        axes.set_xlabel("position of the sub-array, elements" if lowest else "", fontsize=9)
    figure.suptitle(f"Recorded array, {recordings[0].system}", fontsize=11)
    figure.supylabel("arrival angle, deg", fontsize=10)
    _explain(figure, markers, any(not result.apart.all() for result in recordings))
    figure.savefig(path, dpi=120)
    return path


def _explain(figure: Figure, markers: dict[float, str], shaded: bool) -> None:
    """Say below the pictures what lines, marks and shades are."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Line2D | Patch] = [Line2D([], [], color="0.3", linewidth=1, label="surveyed")]
    handles += [
        Line2D(
            [], [], color="0.3", linestyle="", marker=marker, markersize=4,
            label=f"tracked, {frequency:g} Hz",
        )
        for frequency, marker in markers.items()
    ]  # fmt: skip
    handles.append(
        Line2D([], [], color="black", linestyle="", marker="x", label="track of no source")
    )
    if shaded:
        handles.append(
            Patch(color=_SHADE, label=f"nearer than {APART_DEG:g} deg, not in the percentages")
        )
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), fontsize=9)


def _draw_case(axes: Axes, recordings: Sequence[RoomResult], markers: dict[float, str]) -> None:
    sources = recordings[0].sources
    positions = np.arange(len(recordings[0].truth))
    apart = recordings[0].apart
    if len(sources) > 1 and not apart.all():
        axes.fill_between(
            positions, 0.0, 1.0, where=~apart, transform=axes.get_xaxis_transform(),
            color=_SHADE, step="mid", linewidth=0.0,
        )  # fmt: skip
    for column, source in enumerate(sources):
        colour = COLOURS[column % len(COLOURS)]
        axes.plot(np.degrees(recordings[0].truth[:, column]), color=colour, linewidth=1)
        for recording in recordings:
            axes.plot(
                np.degrees(recording.tracked[:, column]), color=colour, linestyle="",
                marker=markers[recording.frequency], markersize=3, fillstyle="none",
                markeredgewidth=0.7,
            )  # fmt: skip
        axes.plot([], [], color=colour, label=f"source {source}")
    for recording in recordings:
        for extra in np.degrees(recording.extra).T:
            axes.plot(positions, extra, "x", color="black", markersize=4, markeredgewidth=0.9)
    axes.set_title(_title(recordings), fontsize=8)
    axes.legend(fontsize=7, loc="upper right")
    axes.grid(alpha=0.3)


def _title(recordings: Sequence[RoomResult]) -> str:
    """Return shares of found and rightly counted sub-arrays, of pairs where they are apart."""
    sources = recordings[0].sources
    single = len(sources) == 1
    name = f"source {sources[0]}" if single else f"sources {sources[0]} and {sources[1]}"
    masks = [np.ones(len(r.truth), bool) if single else r.apart for r in recordings]
    pairs = list(zip(recordings, masks, strict=True))
    if not any(mask.any() for mask in masks):
        return f"{name}: nowhere {APART_DEG:g} deg apart"
    found = np.concatenate([np.isfinite(r.tracked[mask]).all(axis=1) for r, mask in pairs])
    right = np.concatenate([r.miscount[mask] == 0 for r, mask in pairs])
    return f"{name}: found {100 * found.mean():.0f} %, count right {100 * right.mean():.0f} %"
