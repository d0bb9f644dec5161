"""Protects smoothing of recorded tracks: better than what was said at the time, and honest."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import simulate_runs
from sonar_tracking.tma.batch.track_smoother import (
    TrackPath,
    process_noise,
    smooth_path,
)
from sonar_tracking.tma.estimators.range_bank import RangeBank

ACCELERATION = 0.3


def filtered(seed: int, n: int = 60) -> tuple[TrackPath, FloatArray]:
    """Return a path that a Kalman filter of position fixes of 10 m found, and the truth."""
    generator = np.random.default_rng(seed)
    transition = np.eye(4)
    transition[0, 2] = transition[1, 3] = 1.0
    along = np.array([[1.0 / 3.0, 0.5], [0.5, 1.0]])
    noise = ACCELERATION**2 * np.kron(along, np.eye(2))
    root = np.linalg.cholesky(noise)
    truth = [np.array([0.0, 0.0, 3.0, -2.0])]
    for _ in range(n - 1):
        truth.append(transition @ truth[-1] + root @ generator.standard_normal(4))
    spread = np.diag([100.0, 100.0, 25.0, 25.0])
    mean = truth[0] + np.sqrt(np.diag(spread)) * generator.standard_normal(4)
    means, covariances = [], []
    for number, state in enumerate(truth):
        if number:
            mean, spread = transition @ mean, transition @ spread @ transition.T + noise
            gain = spread[:, :2] @ np.linalg.inv(spread[:2, :2] + 100.0 * np.eye(2))
            fix = state[:2] + 10.0 * generator.standard_normal(2)
            mean, spread = mean + gain @ (fix - mean[:2]), spread - gain @ spread[:2]
        means.append(mean)
        covariances.append(spread)
    path = TrackPath(np.arange(float(n)), np.array(means), np.array(covariances))
    return path, np.array(truth)


@pytest.mark.slow
def test_smoothed_states_are_better_and_their_covariance_is_right() -> None:
    errors, nees = [], []
    for seed in range(40):
        path, truth = filtered(seed)
        smoothed = smooth_path(path, ACCELERATION)
        errors.append([np.mean((one.mean - truth) ** 2) for one in (path, smoothed)])
        nees.append(normalised_squared(smoothed.mean - truth, smoothed.covariance))
        assert np.array_equal(smoothed.mean[-1], path.mean[-1])
        assert np.all(np.linalg.eigvalsh(smoothed.covariance) > 0.0)
    before, after = np.mean(errors, axis=0)
    assert after < 0.6 * before
    assert np.mean(nees) == pytest.approx(1.0, abs=0.1)


def test_as_much_motion_is_allowed_for_as_the_filter_did() -> None:
    moved, given = np.diag([100.0, 100.0, 1.0, 2.0]), 0.01
    along = np.array([[8.0 / 3.0, 2.0], [2.0, 2.0]])
    known_better = process_noise(moved, 0.5 * moved, 2.0, given)
    assert known_better == pytest.approx(1e-4 * np.kron(along, np.eye(2)))
    turned = moved + np.diag([0.0, 0.0, 3.0, 0.5])
    assert process_noise(moved, turned, 2.0, given) == pytest.approx(
        1.5 * np.kron(along, np.eye(2))
    )


@pytest.mark.slow
def test_positions_of_the_range_bank_are_known_earlier_with_hindsight() -> None:
    """Own ship's first turn is at 100 s; the range is not known before."""
    runs = simulate_runs(scenario("S1"), np.random.SeedSequence(15).spawn(8))
    bank = RangeBank()
    estimates = [bank.update(measurement) for measurement in runs.frames()]
    before: list[float] = []
    after: list[float] = []
    nees = []
    for run in range(8):
        path = TrackPath(
            runs.scene.times,
            np.array([one.mean[run] for one in estimates]),
            np.array([one.covariance[run] for one in estimates]),
        )
        smoothed = smooth_path(path, 0.01)
        for kept, one in ((before, path), (after, smoothed)):
            kept.append(np.hypot(*(one.mean - runs.truth[run])[90, :2]))
        nees.append(normalised_squared(smoothed.mean - runs.truth[run], smoothed.covariance))
    assert np.sqrt(np.mean(np.square(after))) < 0.2 * np.sqrt(np.mean(np.square(before)))
    assert np.mean(np.array(nees)[:, 20:]) < 2.0
