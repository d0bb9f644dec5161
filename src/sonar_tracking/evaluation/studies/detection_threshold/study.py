"""Study detection-threshold: Figs. 1 and 2 of Jung and Shin (2002), with what they leave out.

The first table compares the closed form of the best false-alarm probability with the exact optimum
over signal-to-noise ratio and number of cells in the gate; the second tracks one target with
thresholds that are fixed, closed-form and exact, for three rules of association. One lost run owns
a root mean square error: judge by the median and the share of lost runs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.active.detection.detection_threshold import (
    FalseAlarmLimits,
    closed_form_false_alarm_probability,
    linear_from_decibel,
)
from sonar_tracking.active.detection.information_reduction import (
    exact_information_reduction,
    optimal_false_alarm_probability,
)
from sonar_tracking.evaluation.monte_carlo.batch_runner import Task, run_batches
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.detection_threshold.figures import draw_errors, draw_optima
from sonar_tracking.evaluation.studies.detection_threshold.runs import (
    POSITION_DEVIATION,
    SCENES,
    SYSTEMS,
    ThresholdRuns,
    riccati_error,
    threshold_batch,
)
from sonar_tracking.records.arrays import FloatArray

LEVELS_DB = (5.0, 10.0, 15.0, 20.0)
CELLS = (2.0, 5.0, 20.0, 50.0, 100.0, 1000.0)
FIXED = 1e-2
OPTIMUM_LIMITS = FalseAlarmLimits(1e-12, 1.0)

SETTLED = 5
"""Scans left out of the errors at the start."""
LAST_SCANS = 3
LOST_DEVIATIONS = 10.0

RUNS_PER_TASK = 5
"""Each run is computed by itself: small tasks leave no worker idle at the end."""

LAYOUTS = (
    TableLayout(
        "False-alarm probability of least expected error (Fig. 1)",
        (
            Column("closed_form_probability", "closed form", ".3e"),
            Column("exact_probability", "exact", ".3e"),
            Column("log10_ratio", "log10 ratio", "+.3f"),
            Column("closed_form_loss_percent", "loss", ".2f"),
            Column("fixed_loss_percent", "loss of 0.01", ".1f"),
        ),
        "Published: the two nearly coincide (no legible axis). loss: of information reduction "
        "factor against the exact optimum, %. n: resolution cells in the gate.",
    ),
    TableLayout(
        "One target in clutter, 35 scans (Fig. 2)",
        (
            Column("median_error_m", "median", ".2f"),
            Column("lost_share", "lost", ".2f"),
            Column("rmse_m", "RMSE", ".1f"),
            Column("kept_rmse_m", "RMSE kept", ".1f"),
            Column("riccati_m", "promised", ".1f"),
            Column("information_reduction", "q2", ".3f"),
        ),
        "Published: with PDA the closed form is below fixed 0.01. Errors in m from the 6th scan "
        "on; lost: more than 100 m RMS in the last 3 scans; promised: modified Riccati equation.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: the tracked runs."""
    return tuple(
        Task(threshold_batch, batch) for batch in run_batches(runs, seed, size=RUNS_PER_TASK)
    )


def rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows."""
    table = [optimum_row(level, cells) for level in LEVELS_DB for cells in CELLS]
    for scene in SCENES:
        for system in SYSTEMS:
            key = (scene.condition, system.name)
            metrics = error_metrics(joined([result[key] for result in results]))
            metrics["riccati_m"] = riccati_error(scene, system, SETTLED)
            table.append(StudyRow(system.name, scene.condition, metrics))
    return tuple(table)


def optimum_row(level_db: float, cells: float) -> StudyRow:
    """Compare the closed form with the exact optimum.

    Parameters
    ----------
    level_db : float
        Signal-to-noise ratio, dB.
    cells : float
        Resolution cells in the gate.
    """
    ratio = float(linear_from_decibel(level_db))
    closed = float(closed_form_false_alarm_probability(cells, ratio, OPTIMUM_LIMITS))
    exact = optimal_false_alarm_probability(cells, ratio, OPTIMUM_LIMITS)
    factors = exact_information_reduction([closed, FIXED, exact], cells, ratio)
    metrics = {
        "closed_form_probability": closed,
        "exact_probability": exact,
        "log10_ratio": float(np.log10(closed / exact)),
        "closed_form_loss_percent": 100.0 * float(1.0 - factors[0] / factors[2]),
        "fixed_loss_percent": 100.0 * float(1.0 - factors[1] / factors[2]),
    }
    return StudyRow(f"n = {cells:g}", f"optimum at {level_db:g} dB", metrics)


def joined(parts: Sequence[ThresholdRuns]) -> ThresholdRuns:
    """Return the runs of all batches as one."""
    return ThresholdRuns(
        np.concatenate([part.error for part in parts]),
        np.concatenate([part.information_reduction for part in parts]),
    )


def error_metrics(runs: ThresholdRuns) -> dict[str, float]:
    """Return the figures of one system under one condition."""
    errors = runs.error[:, SETTLED:]
    last = np.sqrt(np.mean(runs.error[:, -LAST_SCANS:] ** 2, axis=1))
    lost = last > LOST_DEVIATIONS * POSITION_DEVIATION
    kept = errors[~lost]
    return {
        "median_error_m": float(np.median(errors)),
        "lost_share": float(np.mean(lost)),
        "rmse_m": float(np.sqrt(np.mean(errors**2))),
        "kept_rmse_m": float(np.sqrt(np.mean(kept**2))) if kept.size else np.nan,
        "information_reduction": float(np.mean(runs.information_reduction[:, SETTLED:])),
    }


def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    """Write Fig. 1 (optima over cells) and Fig. 2 (errors over time)."""
    histories: Mapping[str, FloatArray] = {
        system.name: joined([result[SCENES[0].condition, system.name] for result in results]).error
        for system in SYSTEMS
        if system.association == "PDA"
    }
    return (
        draw_optima(directory / "figure_1_false_alarm_probability.png", LEVELS_DB),
        draw_errors(directory / "figure_2_position_error.png", histories, SCENES[0].condition),
    )


DETECTION_THRESHOLD = StudyDefinition(
    name="detection-threshold",
    description="detection threshold of least expected tracking error against a fixed one",
    default_runs=100,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
