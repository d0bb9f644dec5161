"""Study track-fusion: one picture of echoes and bearings, beside other rules and the bound.

Four ships that do not hold their courses, a sonar that pings every ten seconds, a line array that
hears them all. Fused with the defaults (but the heading, which is exact here, and told), beside one
filter that is told whose each measurement is and how ships move, at the same ships and pings; rules
that fuse the finished tracks; each source alone; and the posterior Cramer-Rao bound.
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
from sonar_tracking.evaluation.studies.track_fusion.conditions import CONDITIONS, same_sea
from sonar_tracking.evaluation.studies.track_fusion.runs import (
    BEARINGS_ALONE,
    BOUND,
    CENTRAL,
    ECHOES_ALONE,
    FUSED,
    SYSTEMS,
    FusionRun,
    FusionTask,
    fusion_runs,
)

RUNS_PER_TASK = 10

STYLES = {
    FUSED: Style("#D55E00", "o"),
    CENTRAL: Style("#0072B2", "|"),
    "inverse covariance intersection": Style("#009E73", "^"),
    "covariance intersection of tracks": Style("#56B4E9", "v"),
    "naive product of tracks": Style("#CC79A7", "s"),
    ECHOES_ALONE: Style("#999999", "x"),
    BEARINGS_ALONE: Style("#555555", "+"),
    BOUND: Style("#000000", "_"),
}

PANELS = (
    Panel("rmse_m", "position RMSE, m", "log"),
    Panel("nees_per_dimension", "NEES per dimension", "log", right=1.0),
)

LAYOUTS = (
    TableLayout(
        "One picture of echoes and bearings",
        (
            Column("rmse_m", "RMSE", ".1f"),
            Column("per_central", "/central", ".2f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("doubled_percent", "double %", ".1f"),
            Column("one_name_percent", "one name %", ".1f"),
            Column("missing_percent", "missing %", ".1f"),
            Column("alignment_rmse_deg", "align. deg", ".2f"),
            Column("alignment_nees", "its NEES", ".2f"),
        ),
        "RMSE: of positions at the pings from 100 s on, m; of the bound, its root. /central: over "
        "that of the filter that is told. NEES: of the state, per dimension, 1 is right. double: "
        "share of the runs in which a ship had two confirmed rows 60 s after the later one began. "
        "one name: share of the runs in which every ship had one identifier. missing: share of "
        "ships without a row. align.: RMSE of the misalignment at the end.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: a few runs under the conditions of a sea each.

    The longest come first: short tasks at the end leave no worker idle.
    """
    seas = sorted(same_sea(), key=_length, reverse=True)
    names = list(CONDITIONS)
    return tuple(
        Task(fusion_runs, FusionTask(together, batch.seeds))
        for together in seas
        for batch in run_batches(runs, seed, names.index(together[0]), RUNS_PER_TASK)
    )


def _length(together: tuple[str, ...]) -> int:
    """Return how many stations are heard under some conditions."""
    return sum(1 + CONDITIONS[name].moored for name in together)


def rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows."""
    every = [run for part in results for run in part]
    return tuple(
        StudyRow(system, name, figures)
        for name in CONDITIONS
        for own in [[run for run in every if run.condition == name]]
        for system in SYSTEMS
        if (figures := metrics(system, own))
    )


def metrics(system: str, runs: Sequence[FusionRun]) -> dict[str, float]:
    """Return the figures of one system in all runs under a condition."""
    squares = np.array([one for run in runs for one in run.squares[system]])
    if not squares.size:
        return {}
    central = np.array([one for run in runs for one in run.squares[CENTRAL]])
    if system == BOUND:
        squares = np.array([one for run in runs for one in run.claimed[BOUND]])
    figures = {
        "rmse_m": float(np.sqrt(np.mean(squares))),
        "per_central": float(np.sqrt(np.mean(squares) / np.mean(central))),
    }
    if system != BOUND:
        nees = [one for run in runs for one in run.nees[system]]
        figures["nees_per_dimension"] = float(np.mean(nees))
    if system == FUSED:
        error = np.array([run.alignment_error for run in runs])
        deviation = np.array([run.alignment_deviation for run in runs])
        figures |= {
            "doubled_percent": 100.0 * float(np.mean([run.doubled for run in runs])),
            "one_name_percent": 100.0 * float(np.mean([run.names == 0 for run in runs])),
            "missing_percent": 100.0
            * sum(run.missing for run in runs)
            / max(sum(run.rows for run in runs), 1),
            "alignment_rmse_deg": float(np.degrees(np.sqrt(np.mean(error**2)))),
            "alignment_nees": float(np.mean((error / deviation) ** 2)),
        }
    return figures


def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    """Write one picture of all conditions."""
    return (draw_conditions(directory / "track_fusion.png", rows, PANELS, STYLES),)


TRACK_FUSION = StudyDefinition(
    name="track-fusion",
    description="one picture of echoes and bearings, beside other rules and the bound",
    default_runs=50,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
"""``sonar-tracking evaluate track-fusion``."""
