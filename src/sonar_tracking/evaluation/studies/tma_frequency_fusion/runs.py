"""Runs of the tma-frequency-fusion study: every estimator on the same measurements."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import (
    TmaHistories,
    history_of,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import SYSTEMS
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaScene, simulate_runs
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration
from sonar_tracking.tma.performance.posterior_cramer_rao_bound import polar_bound, posterior_bound

BOUND_PATHS = 400
"""True paths the bound is averaged over: fewer change it by more than a few per cent."""


@dataclass(frozen=True)
class SceneBatch:
    """Runs of one scenario.

    Attributes
    ----------
    scenario : str
        S1, S2 or S3.
    batch : RunBatch
        Which runs.
    """

    scenario: str
    batch: RunBatch


@dataclass(frozen=True)
class SceneHistories:
    """What all estimators did in the runs of a batch.

    Attributes
    ----------
    scenario : str
        S1, S2 or S3.
    systems : dict of str to TmaHistories
        By name of the estimator.
    """

    scenario: str
    systems: dict[str, TmaHistories]


@dataclass(frozen=True)
class SceneBound:
    """The least errors possible.

    Attributes
    ----------
    scenario : str
        S1, S2 or S3.
    bound : ndarray, shape (n_frames, 4)
        Root of the bound on range (m), azimuth (deg), course (deg) and speed (m/s).
    """

    scenario: str
    bound: FloatArray


def estimate_batch(part: SceneBatch) -> SceneHistories:
    """Run all estimators on the runs of a batch.

    Parameters
    ----------
    part : SceneBatch
        Scenario and runs.
    """
    runs = simulate_runs(scenario(part.scenario), part.batch.seeds)
    return SceneHistories(
        part.scenario, {name: history_of(make(), runs) for name, make in SYSTEMS.items()}
    )


def bound_of(part: SceneBatch) -> SceneBound:
    """Return the posterior bound of a scenario, averaged over true paths.

    Parameters
    ----------
    part : SceneBatch
        Scenario, and the runs whose true paths are used.
    """
    return SceneBound(part.scenario, scene_bound(scenario(part.scenario), part.batch))


def scene_bound(scene: TmaScene, batch: RunBatch, maximum_range: float = 20_000.0) -> FloatArray:
    """Return the root of the bounds on the four errors.

    Parameters
    ----------
    scene : TmaScene
        The scene.
    batch : RunBatch
        Runs whose true paths are used.
    maximum_range : float
        Of the prior, m.

    Returns
    -------
    ndarray, shape (n_frames, 4)
        On range, azimuth, course and speed, m, deg, deg, m/s.
    """
    runs = simulate_runs(scene, batch.seeds)
    true_azimuth = np.arctan2(*(scene.target[:2] - scene.sensor_position[0])[::-1])
    first = replace(next(runs.frames()), azimuth=np.atleast_1d(true_azimuth))
    prior = SingleFilterConfiguration(maximum_range=maximum_range).start(first)
    bounds = posterior_bound(
        runs.truth,
        scene.line_frequency,
        runs.frames(),
        prior.covariance[..., 0, :4, :4].reshape(-1, 4, 4)[0],
        scene.acceleration,
    )
    mean_path = np.mean(runs.truth, axis=0)
    errors = np.stack(
        [
            polar_bound(bound, mean_path[frame], scene.sensor_position[frame])
            for frame, bound in enumerate(bounds)
        ]
    )
    errors[:, 1:3] = np.degrees(errors[:, 1:3])
    return errors
