"""Batch estimators of the tma-frequency-fusion study, on S1.

With a target that moves exactly straight, and with the study's random accelerations: the maximum
likelihood of a straight motion is efficient in the first case, and claims far too much in the
second; the most probable path is consistent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import (
    TmaHistories,
    frame_metrics,
    joined,
    polar_errors,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import scene_bound
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, simulate_runs
from sonar_tracking.tma.baselines.cheong_fused_line import fused_frames
from sonar_tracking.tma.batch.batch_likelihood import estimate_batch_likelihood
from sonar_tracking.tma.batch.batch_smoother import estimate_batch_path

CONDITION = "batch: "
"""How the condition of these rows begins."""

LIKELIHOOD = "maximum likelihood, straight"
FUSED_LIKELIHOOD = "the same on the paper's fused line"
PATH = "most probable path"

STRAIGHT, RANDOM = "target exactly straight, S1", "random accelerations, S1"


@dataclass(frozen=True)
class BatchHistories:
    """What the batch estimators did, at the last frame only.

    Attributes
    ----------
    histories : dict of (str, str) to TmaHistories
        By estimator and motion, shape (n_runs, 1).
    """

    histories: dict[tuple[str, str], TmaHistories]


def estimate_whole_batch(batch: RunBatch) -> BatchHistories:
    """Run the batch estimators on the runs of a batch.

    Parameters
    ----------
    batch : RunBatch
        Which runs.
    """
    scene = scenario("S1")
    straight = simulate_runs(replace(scene, acceleration=0.0), batch.seeds)
    likelihood = estimate_batch_likelihood(list(straight.frames()))
    histories = {(LIKELIHOOD, STRAIGHT): _last(straight, likelihood.mean, likelihood.covariance)}
    fused = estimate_batch_likelihood(fused_frames(list(straight.frames())))
    histories[FUSED_LIKELIHOOD, STRAIGHT] = _last(straight, fused.mean, fused.covariance)
    moving = simulate_runs(scene, batch.seeds)
    frames = list(moving.frames())
    likelihood = estimate_batch_likelihood(frames)
    path = estimate_batch_path(frames, likelihood)
    histories[LIKELIHOOD, RANDOM] = _last(moving, likelihood.mean, likelihood.covariance)
    histories[PATH, RANDOM] = _last(moving, path.mean[:, -1], path.covariance[:, -1])
    return BatchHistories(histories)


def batch_rows(parts: Sequence[BatchHistories], bound: FloatArray) -> tuple[StudyRow, ...]:
    """Return the rows of the batch estimators.

    Parameters
    ----------
    parts : sequence of BatchHistories
        All batches.
    bound : ndarray, shape (n_frames, 4)
        Of S1 with random accelerations: root of the bounds on range, azimuth, course and
        speed, m, deg, deg, m/s.
    """
    still = replace(scenario("S1"), acceleration=0.0)
    alone = RunBatch(0, (np.random.SeedSequence(0),))
    bounds = {STRAIGHT: scene_bound(still, alone)[-1:], RANDOM: bound[-1:]}
    rows = []
    for system, motion in parts[0].histories:
        own = joined([part.histories[system, motion] for part in parts])
        metrics = frame_metrics(own, bounds[motion], -1)
        metrics["batch_range_rmse_m"] = metrics.pop("range_rmse_m")
        rows.append(StudyRow(system, f"{CONDITION}{motion}", metrics))
    return tuple(rows)


def _last(runs: TmaRuns, mean: FloatArray, covariance: FloatArray) -> TmaHistories:
    truth = runs.truth[:, -1]
    error = polar_errors(mean, truth, runs.scene.sensor_position[-1])
    none = np.zeros((len(mean), 1), dtype=bool)
    return TmaHistories(
        error[:, None], normalised_squared(mean - truth, covariance)[:, None], none, none
    )
