"""Study mismatch-bearings: the default bearing chain where nothing is as it takes it to be.

Long intervals between bursts, weaving targets, pairs that the array hardly tells apart, encounters
after which names may be exchanged, noise of a colour that nobody told, arrays with wrong gains and
phases, exchanged and inverted channels: with default parameters. Beside it the same chain told the
truth, with the number of sources, their first bearings, what they do, the noise and a corrected
array; and the bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import Task, run_batches
from sonar_tracking.evaluation.monte_carlo.condition_panels import Panel, draw_conditions
from sonar_tracking.evaluation.monte_carlo.plot_styles import Style
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.mismatch_bearings.bound import bound_deg2
from sonar_tracking.evaluation.studies.mismatch_bearings.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_bearings.runs import (
    DEFAULTS,
    STARTING,
    TOLD,
    WITHOUT,
    MismatchRun,
    MismatchTask,
    mismatch_runs,
)

RUNS_PER_TASK = 50

STYLES = {
    DEFAULTS: Style("#D55E00", "o"),
    TOLD: Style("#0072B2", "|"),
    WITHOUT: Style("#009E73", "_"),
}

PANELS = (
    Panel("rmse_over_bound", "RMSE over the bound", "log", right=1.0),
    Panel("nees_per_dimension", "NEES per dimension", "log", right=1.0),
    Panel("count_right_percent", "count right, %"),
    Panel("false_tracks", "false tracks a run", "symlog"),
)

LAYOUTS = (
    TableLayout(
        "Bearings with default parameters, and told the truth",
        (
            Column("rmse_deg", "RMSE", ".3f"),
            Column("rmse_over_bound", "/ bound", ".2f"),
            Column("median_nees_per_dimension", "NEES med.", ".2f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("count_right_percent", "count %", ".0f"),
            Column("swaps", "swaps", ".2f"),
            Column("false_tracks", "false", ".2f"),
            Column("silent_false_percent", "silent %", ".0f"),
            Column("clipped_notices", "clipped", ".0f"),
        ),
        "RMSE: deg, of established tracks nearer than 5 deg to a target. / bound: over the bound. "
        "NEES: per dimension, median and mean over the runs, 1 is right. count: periods with as "
        "many confirmed tracks as targets. swaps: lasting ones, a run. false: tracks a run that "
        "are near no target for half their life. silent: runs with one and without a notice. "
        "clipped: notices of clipped elements a run; no element is.",
    ),
    TableLayout(
        "Encounters",
        (Column("right_names_percent", "right names %", ".0f"),),
        "Targets that have the same name in the end as before.",
    ),
    TableLayout(
        "Faulty channels",
        (Column("named_percent", "named %", ".0f"),),
        "Runs in which a notice names the channels.",
    ),
    TableLayout(
        "Faint sources",
        (
            Column("false_per_hour", "false an hour", ".2f"),
            Column("within_20_s_percent", "in 20 s %", ".0f"),
            Column("within_60_s_percent", "in 60 s %", ".0f"),
            Column("start_s", "median s", ".1f"),
        ),
        "Runs in which the source has a track after so long, and the median of the time it takes; "
        "with track-before-detect, which is the default, and without.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: a few runs under a condition each.

    Those with the most estimates come first, or a long one at the end leaves workers idle.
    """
    parts = {name: part for part, name in enumerate(CONDITIONS)}
    return tuple(
        Task(mismatch_runs, MismatchTask(name, batch.seeds))
        for name in sorted(CONDITIONS, key=lambda name: -CONDITIONS[name].n_estimates)
        for batch in run_batches(runs, seed, parts[name], RUNS_PER_TASK)
    )


def rows(results: Sequence[Sequence[MismatchRun]]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows: under each condition the defaults come first."""
    every = [run for part in results for run in part]
    there = {run.condition for run in every}
    return tuple(
        StudyRow(
            system,
            name,
            system_metrics([run.metrics[system] for run in every if run.condition == name], name),
        )
        for name in CONDITIONS
        if name in there
        for system in _systems(name)
    )


def _systems(condition: str) -> tuple[str, str]:
    return (DEFAULTS, WITHOUT if CONDITIONS[condition].faint else TOLD)


def system_metrics(runs: Sequence[Any], condition: str) -> dict[str, float]:
    """Return the figures of one chain under one condition.

    Parameters
    ----------
    runs : sequence of mapping of str to float
        Its figures in all runs.
    condition : str
        Name of the condition.
    """
    columns = {name: np.array([one[name] for one in runs]) for name in runs[0]}
    metrics = {name: _or_nan(np.mean, column) for name, column in columns.items()}
    # One run with a collapsed covariance owns the mean.
    metrics["median_nees_per_dimension"] = _or_nan(np.median, columns["nees_per_dimension"])
    metrics["rmse_deg"] = float(np.sqrt(metrics["mse_deg2"]))
    metrics["bound_deg"] = float(np.sqrt(bound_deg2(CONDITIONS[condition])))
    metrics["rmse_over_bound"] = metrics["rmse_deg"] / metrics["bound_deg"]
    metrics["start_s"] = float(np.median(columns["start_s"]))
    for name in ("right_names_percent", "named_percent", *STARTING):
        if not np.isfinite(metrics[name]):
            # Not asked under this condition: no row of that table.
            del metrics[name]
    return metrics


def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    """Write one picture of all conditions."""
    return (draw_conditions(directory / "mismatch_bearings.png", rows, PANELS, STYLES),)


def _or_nan(statistic: Any, values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(statistic(known)) if known.size else np.nan


MISMATCH_BEARINGS = StudyDefinition(
    name="mismatch-bearings",
    description="the default bearing chain in scenes it was not tuned for, beside one told",
    default_runs=50,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
