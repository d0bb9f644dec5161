"""Study doa-start: targets that appear, fade, cross and leave, tracked from nothing.

The product's passive chain by default: joint maximum a posteriori tracker with automatic start, on
three arrays and at four levels. No figures are published for this; the table tells what a user may
expect.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import Task, run_batches
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.doa_start.runs import (
    CONDITIONS,
    StartBatch,
    StartRun,
    StartRuns,
    start_batch,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.time import seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SYSTEM = "joint MAP"

RUNS_PER_TASK = {15: 50, 32: 50, 64: 20}
"""Tracked together, by the elements of the array: of a large one more would save little, need much
memory and leave workers idle."""

LAYOUTS = (
    TableLayout(
        "Five targets from nothing, 120 s, 200 snapshots/s",
        (
            Column("count_error", "count error", ".2f"),
            Column("count_right_percent", "count right", ".0f"),
            Column("confirmation_delay_s", "delay", ".1f"),
            Column("largest_confirmation_delay_s", "worst", ".1f"),
            Column("targets_never_held", "missed", ".2f"),
            Column("false_tracks_per_hour", "false/h", ".1f"),
            Column("lasting_swaps", "swaps", ".2f"),
            Column("name_kept_percent", "identity maintained", ".1f"),
            Column("gospa_deg", "GOSPA", ".2f"),
            Column("rmse_deg", "RMSE", ".2f"),
        ),
        "Means over the runs. count error: confirmed tracks against targets, mean without sign; "
        "right in % of the periods. delay: from the appearance of a target to the end of the "
        "period of its confirmed track, s; worst: of the slowest target in any run. missed: "
        "targets without a track, a run. swaps: exchanges of identity for 2.5 s or longer, a run, "
        "there and back counted both. identity maintained: share of its life that a target has its "
        "longest identity, %. GOSPA: deg, cut-off 5 deg, order 2; a track that coasts after "
        "its target has left counts against it.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: the tracked runs of every condition.

    Those of the largest array come first: short tasks at the end leave no worker idle.
    """
    return tuple(
        Task(start_batch, StartBatch(condition, batch))
        for part, condition in reversed(list(enumerate(CONDITIONS)))
        for batch in run_batches(runs, seed, part, RUNS_PER_TASK[condition.n_elements])
    )


def rows(results: Sequence[StartRuns]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows."""
    table = []
    for condition in CONDITIONS:
        runs = [run for part in results if part.condition == condition for run in part.runs]
        if runs:
            table.append(StudyRow(SYSTEM, condition.name, _metrics(runs)))
    return tuple(table)


def draw(
    results: Sequence[StartRuns], rows: Sequence[StudyRow], directory: Path
) -> tuple[Path, ...]:
    """Write one figure an array: true and tracked bearings of the first run at each level."""
    import matplotlib.pyplot as plt

    directory.mkdir(parents=True, exist_ok=True)
    pictures = []
    for n_elements in dict.fromkeys(condition.n_elements for condition in CONDITIONS):
        shown = {
            part.condition: part.example
            for part in results
            if part.condition.n_elements == n_elements and part.example is not None
        }
        conditions = [condition for condition in CONDITIONS if condition in shown]
        figure, panels = plt.subplots(
            1,
            len(conditions),
            figsize=(4.5 * len(conditions), 5),
            sharey=True,
            squeeze=False,
            layout="constrained",
        )
        for axes, condition in zip(panels[0], conditions, strict=True):
            _draw_example(axes, *shown[condition])
            axes.set(title=condition.name, xlabel="time (s)")
        panels[0, 0].set_ylabel("arrival angle (deg)")
        path = directory / f"start_{n_elements}_elements.png"
        figure.savefig(path, dpi=120)
        plt.close(figure)
        pictures.append(path)
    return tuple(pictures)


def _metrics(runs: Sequence[StartRun]) -> dict[str, float]:
    scores = [run.score for run in runs]
    identities = [score.identities for score in scores]
    delays = [identity.confirmation_delay for identity in identities]
    worst = [identity.largest_confirmation_delay for identity in identities]
    return {
        "count_error": float(np.mean([run.count_error for run in runs])),
        "count_right_percent": 100.0 * float(np.mean([run.count_right for run in runs])),
        "confirmation_delay_s": float(_known(delays).mean()),
        "largest_confirmation_delay_s": float(_known(worst).max()),
        "targets_never_held": float(np.mean([entry.targets_never_held for entry in identities])),
        "false_tracks_per_hour": float(
            np.mean([entry.false_tracks_per_hour for entry in identities])
        ),
        "swaps": float(np.mean([entry.identity_swaps for entry in identities])),
        "lasting_swaps": float(np.mean([entry.lasting_identity_swaps for entry in identities])),
        "name_kept_percent": 100.0 * float(np.mean([entry.continuity for entry in identities])),
        "gospa_deg": float(np.mean([score.gospa_deg for score in scores])),
        "rmse_deg": float(_known([score.rmse_deg for score in scores]).mean()),
    }


def _known(values: Sequence[float]) -> FloatArray:
    """Return the finite values, or one that is not a number."""
    known = np.array(values)[np.isfinite(values)]
    return known if known.size else np.array([np.nan])


def _draw_example(
    axes: Axes, truth: tuple[BearingTracks, ...], tracks: tuple[BearingTracks, ...]
) -> None:
    first = truth[0].stamp
    axes.scatter(*_points(truth, first)[:2], color="0.7", s=6.0)
    times, angles, names = _points(tracks, first)
    axes.scatter(times, angles, c=names, cmap="tab10", s=3.0)


def _points(
    entries: tuple[BearingTracks, ...], first: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return time in s, angle in deg and identifier of all established rows."""
    points = [
        (seconds(entry.stamp - first), np.degrees(entry.arrival_angle[row]), entry.id[row])
        for entry in entries
        for row in np.flatnonzero(entry.established)
    ]
    times, angles, names = np.array(points, dtype=np.float64).reshape(-1, 3).T
    return times, angles, names


DOA_START = StudyDefinition(
    name="doa-start",
    description="targets that appear, fade, cross and leave, tracked from nothing",
    default_runs=10,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
