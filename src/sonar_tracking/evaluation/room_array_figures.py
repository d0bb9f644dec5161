"""Pictures of the room-array study: bearing and error at every position of the sub-array."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonar_tracking.evaluation.study import StudyRow

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


def draw_room_array(
    results: Sequence[Any], rows: Sequence[StudyRow], directory: Path
) -> tuple[Path, ...]:
    """Draw surveyed and tracked bearings of every recording.

    Parameters
    ----------
    results : sequence
        What the tasks returned: sequences of RoomResult.
    rows : sequence of StudyRow
        Rows of the study.
    directory : Path
        Where to write.

    Returns
    -------
    tuple of Path
        The picture.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    recordings = [result for task in results for result in task]
    cases = list(dict.fromkeys(result.sources for result in recordings))
    figure = Figure(figsize=(11, 8), layout="constrained")
    FigureCanvasAgg(figure)
    n_columns = min(4, len(cases))
    grid = figure.subplots(-(-len(cases) // n_columns), n_columns, sharex=True, squeeze=False)
    for axes in grid.ravel()[len(cases) :]:
        axes.remove()
    for axes, case in zip(grid.ravel(), cases, strict=False):
        _draw_case(axes, [result for result in recordings if result.sources == case])
    figure.supxlabel("position of the sub-array, elements")
    figure.supylabel("arrival angle, deg (line: surveyed, points: tracked)")
    directory.mkdir(parents=True, exist_ok=True)
    path = directory / "room_array.png"
    figure.savefig(path, dpi=120)
    return (path,)


def _draw_case(axes: Axes, recordings: Sequence[Any]) -> None:
    sources = recordings[0].sources
    for column, source in enumerate(sources):
        colour = COLOURS[column]
        axes.plot(np.degrees(recordings[0].truth[:, column]), color=colour, linewidth=1)
        for recording in recordings:
            axes.plot(np.degrees(recording.tracked[:, column]), ".", color=colour, markersize=3)
        axes.plot([], [], color=colour, label=f"source {source}")
    axes.legend(fontsize=7, loc="upper right")
    axes.grid(alpha=0.3)
