"""Study mismatch-contacts: the default contact tracker beside the same one told the truth.

Every parameter of a tracker is somebody's scene. Ships of any speed, turns, sensors of any grain,
probabilities of detection that are told wrong or not at all, clutter with heavy tails, convoys,
crossings, a wharf: with parameters nobody has chosen for them, and contacts that tell what a sensor
knows of itself. Beside it the same tracker on the same contacts, told what is true.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
from sonar_tracking.evaluation.studies.mismatch_contacts.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_contacts.runs import (
    DEFAULTS,
    TOLD,
    MismatchRun,
    MismatchTask,
    mismatch_runs,
)
from sonar_tracking.records.arrays import FloatArray

STYLES = {DEFAULTS: Style("#D55E00", "o"), TOLD: Style("#0072B2", "|")}

PANELS = (
    Panel("held_share", "time maintained"),
    Panel("nees_per_dimension", "NEES per dimension", "log", right=1.0),
    Panel("false_tracks_per_hour", "false tracks an hour", "symlog"),
    Panel("ospa_over_told", "OSPA over that of told", right=1.0),
)

LAYOUTS = (
    TableLayout(
        "Tracks with default parameters, and told the truth",
        (
            Column("held_share", "maintained", ".3f"),
            Column("settled_held_share", "from 11th", ".3f"),
            Column("false_tracks_per_hour", "false/h", ".1f"),
            Column("identity_swaps", "swaps", ".2f"),
            Column("continuity", "contin.", ".2f"),
            Column("median_nees_per_dimension", "NEES med.", ".2f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("ospa_m", "OSPA", ".1f"),
            Column("ospa_over_told", "/ told", ".2f"),
            Column("cpu_ms", "ms", ".2f"),
        ),
        "maintained: share of time with a confirmed track; from 11th: of the 11th ping of each "
        "target on. swaps a run. NEES per dimension, 1 is right: median and mean over the runs. "
        "OSPA: m, order 2, cut-off 200 m (coarse sensor 500 m, fine sensor 50 m, wharf 30 m). ms: "
        "processor time a ping of a tracker by itself, in the first run.",
    ),
    TableLayout(
        "Things that do not move",
        (
            Column("fast_share_of_fixed", "> 1 m/s", ".3f"),
            Column("identities_per_target", "identities", ".2f"),
            Column("moving_continuity", "boat", ".2f"),
        ),
        "> 1 m/s: share of their tracks that claim more; identities: confirmed ones, over the "
        "number of all targets; boat: continuity of what moves beside them.",
    ),
)


RUNS_TOGETHER = 100
"""Runs of a task: with few contacts each, more of them cost less."""

CROWDED, RUNS_IN_A_CROWD = "K-distributed clutter, shape 0.5", 10
"""Where the arrays of more do not stay near the processor."""


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: a few runs under a condition each."""
    return tuple(
        Task(mismatch_runs, MismatchTask(name, batch.seeds, timed=batch.first_run == 0))
        for part, name in enumerate(CONDITIONS)
        for batch in run_batches(
            runs, seed, part, RUNS_IN_A_CROWD if name == CROWDED else RUNS_TOGETHER
        )
    )


def rows(results: Sequence[Sequence[MismatchRun]]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows: under each condition the defaults come first."""
    table = []
    every = [run for part in results for run in part]
    for name in dict.fromkeys(run.condition for run in every):
        runs = [run for run in every if run.condition == name]
        told = system_metrics(runs, TOLD)
        for system in (DEFAULTS, TOLD):
            metrics = system_metrics(runs, system)
            metrics["ospa_over_told"] = metrics["ospa_m"] / told["ospa_m"]
            table.append(StudyRow(system, name, metrics))
    return tuple(table)


def system_metrics(runs: Sequence[MismatchRun], system: str) -> dict[str, float]:
    """Return the figures of one tracker under one condition.

    Parameters
    ----------
    runs : sequence of MismatchRun
        All of the condition.
    system : str
        Name of the tracker.
    """
    own: list[Mapping[str, float]] = [run.metrics[system] for run in runs]
    columns = {name: _known([metrics[name] for metrics in own]) for name in own[0]}
    metrics = {name: _or_nan(np.mean, column) for name, column in columns.items()}
    # One run with a collapsed covariance owns the mean.
    metrics["median_nees_per_dimension"] = _or_nan(np.median, columns["nees_per_dimension"])
    return metrics


def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    """Write one picture of all conditions."""
    return (draw_conditions(directory / "mismatch_contacts.png", rows, PANELS, STYLES),)


def _known(values: Sequence[float]) -> FloatArray:
    column = np.array(values)
    return column[np.isfinite(column)]


def _or_nan(statistic: Any, values: FloatArray) -> float:
    return float(statistic(values)) if values.size else np.nan


MISMATCH_CONTACTS = StudyDefinition(
    name="mismatch-contacts",
    description="the default contact tracker in scenes it was not tuned for, beside one told",
    default_runs=50,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
