"""Study mismatch-positions: the default position tracker where nothing is as told.

Bearing errors that last, deviations that are told too small, lines that wander, targets that weave,
turn or are farther away than expected: with default parameters. Beside it the same estimator that
believes everything it is told and knows of no turns; the same one told the truth; and the bound of
a scene without any of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch, Task, run_batches
from sonar_tracking.evaluation.monte_carlo.condition_panels import Panel, draw_conditions
from sonar_tracking.evaluation.monte_carlo.plot_styles import Style
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.mismatch_positions.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_positions.runs import (
    BOUND_PATHS,
    DEFAULTS,
    NOTHING_LEARNT,
    TOLD,
    MismatchBound,
    MismatchRuns,
    MismatchTask,
    Outcomes,
    mismatch_bound,
    mismatch_runs,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import LOST_BOUNDS
from sonar_tracking.records.arrays import BoolArray, FloatArray

SYSTEMS = (DEFAULTS, NOTHING_LEARNT, TOLD)

RUNS_PER_TASK = 100
"""A frame of a hundred costs little more than one of fifty."""

SURPRISED = 20.0
"""A confirmed row whose NEES per dimension is larger is wrong and does not say so."""

LATER = 60
"""Frames after the first that counts: a target's turn should have been found by then."""

STYLES = {
    DEFAULTS: Style("#D55E00", "o"),
    NOTHING_LEARNT: Style("#999999", "x"),
    TOLD: Style("#0072B2", "|"),
}

PANELS = (
    Panel("range_per_bound", "range RMSE over the bound", "log", right=1.0),
    Panel("nees_per_dimension", "NEES per dimension", "log", right=1.0),
    Panel("surprised_percent", "confirmed rows with NEES > 20, %", "symlog"),
    Panel("lost_percent", "beyond 5 bounds, %"),
)

LAYOUTS = (
    TableLayout(
        "Positions with default parameters, beside the same estimator told otherwise",
        (
            Column("range_rmse_m", "range", ".0f"),
            Column("range_median_m", "median", ".0f"),
            Column("range_per_bound", "/bound", ".2f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("surprised_percent", "> 20 %", ".1f"),
            Column("surprised_later_percent", "later %", ".1f"),
            Column("confirmed_percent", "conf. %", ".0f"),
            Column("lost_percent", "lost %", ".0f"),
        ),
        "range: RMSE in the last frame, m; median of its absolute error. /bound: over the root of "
        "the posterior bound of white errors as the scene has them. NEES: per dimension in the "
        "last frame, mean over the runs, 1 is right. > 20: share of confirmed rows, from frame "
        "100 on (from the turn on where there is one), whose NEES exceeds 20. later: the same "
        "without the first 60 frames of them. conf.: share of "
        "rows whose position is known well enough to be confirmed. lost: beyond 5 bounds.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: a few runs under a condition each, and the bounds."""
    paths = RunBatch(0, tuple(np.random.SeedSequence((seed, 1)).spawn(BOUND_PATHS)))
    return (
        *(
            Task(mismatch_runs, MismatchTask(name, batch))
            for part, name in enumerate(CONDITIONS)
            for batch in run_batches(runs, seed, part, RUNS_PER_TASK)
        ),
        *(Task(mismatch_bound, MismatchTask(name, paths)) for name in CONDITIONS),
    )


def rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows: under each condition the defaults come first."""
    bounds = {one.condition: one.range_m for one in results if isinstance(one, MismatchBound)}
    every = [one for one in results if isinstance(one, MismatchRuns)]
    return tuple(
        StudyRow(
            system,
            name,
            metrics([one.outcomes[system] for one in every if one.condition == name], bounds[name]),
        )
        for name in bounds
        for system in SYSTEMS
    )


def metrics(parts: Sequence[Outcomes], bound: float) -> dict[str, float]:
    """Return the figures of one estimator under one condition.

    Parameters
    ----------
    parts : sequence of Outcomes
        All its runs.
    bound : float
        On the range in the last frame, m.
    """
    error = np.concatenate([part.error for part in parts])
    nees = np.concatenate([part.nees for part in parts])
    confirmed = np.concatenate([part.confirmed for part in parts])
    rmse, size = float(np.sqrt(np.mean(error**2))), np.abs(error)
    return {
        "range_rmse_m": rmse,
        "range_median_m": float(np.median(size)),
        "range_per_bound": rmse / bound,
        "bound_m": bound,
        "nees_per_dimension": float(np.mean(nees[:, -1])),
        "surprised_percent": _surprised_percent(nees, confirmed),
        "surprised_later_percent": _surprised_percent(nees[:, LATER:], confirmed[:, LATER:]),
        "confirmed_percent": 100.0 * float(np.mean(confirmed)),
        "lost_percent": 100.0 * float(np.mean(size > LOST_BOUNDS * bound)),
    }


def _surprised_percent(nees: FloatArray, confirmed: BoolArray) -> float:
    """Return the share of confirmed rows that are wrong; NaN = there is none."""
    surprised = nees[confirmed] > SURPRISED
    return 100.0 * float(np.mean(surprised)) if surprised.size else np.nan


def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    """Write one picture of all conditions."""
    return (draw_conditions(directory / "mismatch_positions.png", rows, PANELS, STYLES),)


MISMATCH_POSITIONS = StudyDefinition(
    name="mismatch-positions",
    description="the default position tracker in scenes it was not tuned for, beside one told",
    default_runs=50,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
