"""Kalman filter: against the textbook equations, over batches, and its consistency statistics."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.consistency import chi_square_band, normalised_squared
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict, update

H = np.array([[1.0, 0.0]])


def test_motion_model_composes() -> None:
    # Two steps of the model are one step of twice the interval.
    q, interval = 0.3, 0.7
    once, noise = transition_matrix(interval), process_noise_matrix(q, interval)
    assert np.allclose(once @ once, transition_matrix(2 * interval))
    assert np.allclose(once @ noise @ once.T + noise, process_noise_matrix(q, 2 * interval))


def test_update_is_the_weighted_mean() -> None:
    state = KalmanState(np.array([1.0, 0.0]), np.diag([4.0, 1.0]))
    result = update(state, np.array([3.0]), H, np.array([[12.0]]))
    assert result.innovation == pytest.approx([2.0])
    assert result.innovation_covariance[0, 0] == pytest.approx(16.0)
    assert result.state.mean == pytest.approx([1.5, 0.0])
    assert result.state.covariance == pytest.approx(np.diag([3.0, 1.0]))


def test_batch_is_many_single_filters() -> None:
    generator = np.random.default_rng(1)
    root = generator.standard_normal((4, 3, 2, 2))
    states = KalmanState(generator.standard_normal((4, 3, 2)), root @ np.swapaxes(root, -1, -2))
    F, Q = transition_matrix(0.5), process_noise_matrix(0.2, 0.5)
    measured = generator.standard_normal((4, 3, 1))
    noise = generator.uniform(0.1, 2.0, (4, 3, 1, 1))
    together = update(predict(states, F, Q), measured, H, noise)
    for index in np.ndindex(4, 3):
        single = KalmanState(states.mean[index], states.covariance[index])
        alone = update(predict(single, F, Q), measured[index], H, noise[index])
        assert np.allclose(together.state.mean[index], alone.state.mean, atol=1e-12)
        assert np.allclose(together.state.covariance[index], alone.state.covariance, atol=1e-12)


def test_each_filter_of_a_batch_may_have_a_motion_of_its_own() -> None:
    """Intervals differ from run to run; F P F^T is not F P F."""
    covariance = np.array([[4.0, 1.0], [1.0, 2.0]])
    state = KalmanState(np.array([[1.0, 2.0], [3.0, 4.0]]), np.stack([covariance] * 2))
    transition = np.stack([transition_matrix(0.5), transition_matrix(2.0)])
    noise = np.stack([process_noise_matrix(1.0, 0.5), process_noise_matrix(1.0, 2.0)])
    together = predict(state, transition, noise)
    for run in range(2):
        alone = predict(KalmanState(state.mean[run], covariance), transition[run], noise[run])
        assert np.allclose(together.mean[run], alone.mean)
        assert np.allclose(together.covariance[run], alone.covariance)
    assert together.covariance[0, 0, 0] == pytest.approx(4.0 + 2 * 0.5 + 0.25 * 2 + 0.125 / 3.0)


def test_covariance_stays_symmetric_and_positive() -> None:
    # An almost exact measurement of an almost unknown state: the short form loses positivity.
    state = KalmanState(np.zeros(2), np.diag([1e6, 1e6]))
    F, Q = transition_matrix(1.0), process_noise_matrix(1e-6, 1.0)
    for step in range(200):
        state = update(predict(state, F, Q), np.array([float(step)]), H, np.array([[1e-6]])).state
        assert np.array_equal(state.covariance, state.covariance.T)
        assert np.linalg.eigvalsh(state.covariance)[0] > 0.0
    assert state.mean[1] == pytest.approx(1.0, abs=1e-6)


def test_filter_tells_the_truth_about_itself() -> None:
    # Data made by the model: NIS and NEES lie in their chi-square bands.
    generator = np.random.default_rng(2)
    runs, steps, q, r = 200, 25, 0.1, 0.5
    F, Q = transition_matrix(1.0), process_noise_matrix(q, 1.0)
    truth = generator.multivariate_normal(np.zeros(2), np.diag([2.0, 0.5]), size=runs)
    covariance = np.broadcast_to(np.diag([2.0, 0.5]), (runs, 2, 2))
    state = KalmanState(np.zeros((runs, 2)), covariance)
    nis = []
    for _ in range(steps):
        truth = truth @ F.T + generator.multivariate_normal(np.zeros(2), Q, size=runs)
        measured = truth[:, :1] + np.sqrt(r) * generator.standard_normal((runs, 1))
        result = update(predict(state, F, Q), measured, H, np.full((runs, 1, 1), r))
        state = result.state
        nis.append(normalised_squared(result.innovation, result.innovation_covariance))
    low, high = chi_square_band(1, runs * steps, 0.999)
    assert low < np.mean(nis) < high
    low, high = chi_square_band(2, runs, 0.999)
    nees = normalised_squared(state.mean - truth, state.covariance)
    assert low < nees.mean() < high


def test_statistics_are_per_dimension() -> None:
    value = normalised_squared(np.array([2.0, 1.0]), np.diag([4.0, 1.0]))
    assert value == pytest.approx(1.0)
    low, high = chi_square_band(2, 100)
    assert low < 1.0 < high
    # For many errors the band is that of a normal mean: 1 -+ 1.96 sqrt(2 / freedom).
    assert high - low == pytest.approx(2 * 1.96 * np.sqrt(2.0 / 200.0), rel=0.02)
