"""Runs under one condition: the same measurements for every estimator, and what they made of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.studies.mismatch_positions.condition import BELIEVING, Condition
from sonar_tracking.evaluation.studies.mismatch_positions.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import scene_bound
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.targets.followed_target import DOUBTFUL
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

DEFAULTS, NOTHING_LEARNT, TOLD = "defaults", "nothing learnt, no turns", "told the truth"

BOUND_PATHS = 100
"""True paths the bound is averaged over."""


@dataclass(frozen=True)
class MismatchTask:
    """Runs that are computed together.

    Attributes
    ----------
    condition : str
        Name of the condition.
    batch : RunBatch
        Which runs; of a bound, those whose true paths are used.
    """

    condition: str
    batch: RunBatch


@dataclass(frozen=True)
class MismatchRuns:
    """What the estimators did in the runs of a task.

    Attributes
    ----------
    condition : str
        Name of the condition.
    outcomes : dict of str to Outcomes
        Of each estimator.
    """

    condition: str
    outcomes: dict[str, Outcomes]


@dataclass(frozen=True)
class MismatchBound:
    """The least error possible with white errors and the motion of the scene.

    Attributes
    ----------
    condition : str
        Name of the condition.
    range_m : float
        Root of the bound on the range in the last frame, m.
    """

    condition: str
    range_m: float


@dataclass(frozen=True)
class Outcomes:
    """What one estimator did in several runs.

    Attributes
    ----------
    error : ndarray, shape (n_runs,)
        Of the range in the last frame, m.
    nees : ndarray, shape (n_runs, n_frames)
        Normalised estimation error squared of the state, per dimension, from the frame on that
        counts.
    confirmed : ndarray of bool, shape (n_runs, n_frames)
        Where the position is known well enough to be confirmed.
    """

    error: FloatArray
    nees: FloatArray
    confirmed: BoolArray


def mismatch_runs(task: MismatchTask) -> MismatchRuns:
    """Simulate runs and follow them with the defaults, believing, and told what is true."""
    condition = CONDITIONS[task.condition]
    runs = condition.draw(condition.scene, task.batch.seeds)
    claimed, true = condition.claimed(runs), condition.true(runs)
    given = {
        DEFAULTS: (RangeBankConfiguration(), claimed),
        NOTHING_LEARNT: (BELIEVING, claimed),
        TOLD: (condition.told, true),
    }
    return MismatchRuns(
        task.condition,
        {name: outcomes(*what, settled=condition.settled) for name, what in given.items()},
    )


def mismatch_bound(task: MismatchTask) -> MismatchBound:
    """Return the bound under a condition."""
    condition: Condition = CONDITIONS[task.condition]
    reach = condition.told.maximum_range
    bound = scene_bound(condition.scene, task.batch, reach)
    return MismatchBound(task.condition, float(bound[-1, 0]))


def outcomes(configuration: RangeBankConfiguration, runs: TmaRuns, settled: int) -> Outcomes:
    """Follow runs with the default estimator.

    Parameters
    ----------
    configuration : RangeBankConfiguration
        Its parameters.
    runs : TmaRuns
        What was measured, and the truth.
    settled : int
        First frame that counts.
    """
    estimator = RangeBank(configuration)
    confirmed = np.zeros(len(runs.truth), dtype=bool)
    nees, stands = [], []
    for frame, measurement in enumerate(runs.frames()):
        estimate = estimator.update(measurement)
        position = runs.scene.sensor_position[frame]
        confirmed = _confirmed(estimate.mean, estimate.covariance, position, confirmed)
        if frame >= settled:
            nees.append(
                normalised_squared(estimate.mean - runs.truth[:, frame], estimate.covariance)
            )
            stands.append(confirmed)
    error = _range(estimate.mean, position) - _range(runs.truth[:, -1], position)
    return Outcomes(error, np.stack(nees, axis=1), np.stack(stands, axis=1))


def _confirmed(
    mean: FloatArray, covariance: FloatArray, position: FloatArray, before: BoolArray
) -> BoolArray:
    """Return where a tracker calls the position confirmed, shape (n_runs,)."""
    part = TmaTrackerConfiguration().confirm_relative_deviation * np.where(before, DOUBTFUL, 1.0)
    variance = np.linalg.eigvalsh(covariance[:, :2, :2])[:, -1]
    return np.asarray(np.sqrt(variance) <= part * _range(mean, position))


def _range(state: FloatArray, position: FloatArray) -> FloatArray:
    offset = state[:, :2] - position
    return np.asarray(np.hypot(offset[:, 0], offset[:, 1]))
