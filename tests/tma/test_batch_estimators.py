"""Protects the batch estimators: efficient where the model holds, consistent where it does not."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, simulate_runs
from sonar_tracking.tma.batch.batch_likelihood import (
    BatchConfiguration,
    BatchEstimate,
    estimate_batch_likelihood,
)
from sonar_tracking.tma.batch.batch_smoother import estimate_batch_path

N_RUNS = 12


def runs_of(acceleration: float) -> TmaRuns:
    scene = replace(scenario("S1"), acceleration=acceleration)
    return simulate_runs(scene, np.random.SeedSequence(8).spawn(N_RUNS))


def position_error(runs: TmaRuns, mean: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.sum((mean - runs.truth[:, -1])[:, :2] ** 2, axis=1))))


@pytest.fixture(scope="module")
def straight() -> tuple[TmaRuns, BatchEstimate]:
    runs = runs_of(0.0)
    return runs, estimate_batch_likelihood(list(runs.frames()))


def test_it_is_efficient_on_a_straight_target(straight: tuple[TmaRuns, BatchEstimate]) -> None:
    runs, estimate = straight
    assert position_error(runs, estimate.mean) < 1.6 * 58.2  # 12 runs: 20 % standard deviation
    nees = normalised_squared(estimate.mean - runs.truth[:, -1], estimate.covariance)
    assert 0.6 < np.mean(nees) < 1.5
    np.testing.assert_allclose(
        estimate.source_frequency, np.tile(runs.scene.line_frequency, (N_RUNS, 1)), atol=1.0
    )


def test_one_start_near_the_target_finds_the_same(
    straight: tuple[TmaRuns, BatchEstimate],
) -> None:
    runs, estimate = straight
    other = estimate_batch_likelihood(
        list(runs.frames()), BatchConfiguration(start_ranges=(5000.0,))
    )
    agrees = np.abs(other.cost - estimate.cost) < 1e-3
    assert np.mean(agrees) > 0.9
    assert np.all(other.cost > estimate.cost - 1e-3)


@pytest.mark.slow
def test_robust_weights_bear_outliers() -> None:
    runs = runs_of(0.0)
    generator = np.random.default_rng(3)
    wild = generator.random(runs.azimuth.shape) < 0.05
    azimuth = np.where(wild, generator.uniform(-np.pi, np.pi, wild.shape), runs.azimuth)
    frames = list(replace(runs, azimuth=azimuth).frames())
    plain = estimate_batch_likelihood(frames, BatchConfiguration(start_ranges=(5000.0,)))
    robust = estimate_batch_likelihood(
        frames, BatchConfiguration(start_ranges=(5000.0,), huber=1.5)
    )
    assert position_error(runs, robust.mean) < 120.0
    assert position_error(runs, plain.mean) > 5.0 * position_error(runs, robust.mean)


@pytest.mark.slow
def test_the_most_probable_path_knows_of_accelerations() -> None:
    runs = runs_of(0.01)
    frames = list(runs.frames())
    likelihood = estimate_batch_likelihood(frames, BatchConfiguration(start_ranges=(5000.0,)))
    path = estimate_batch_path(frames, likelihood)
    truth = runs.truth[:, -1]
    assert np.mean(normalised_squared(likelihood.mean - truth, likelihood.covariance)) > 5.0
    assert 0.6 < np.mean(normalised_squared(path.mean[:, -1] - truth, path.covariance[:, -1])) < 1.6
    middle = normalised_squared(path.mean[:, 200] - runs.truth[:, 200], path.covariance[:, 200])
    assert 0.6 < np.mean(middle) < 1.6
