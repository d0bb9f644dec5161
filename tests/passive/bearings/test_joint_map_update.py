"""The joint filter: a Kalman filter where the block is linear, the prior where it says nothing."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict, update
from sonar_tracking.passive.bearings.joint_map_update import predict_jointly, update_jointly
from sonar_tracking.passive.directions.signal_subspace import signal_subspace
from sonar_tracking.passive.directions.weighted_subspace_fit import (
    SubspaceFit,
    weighted_subspace_fit,
)
from tests.passive.block_scene import (
    ANGLES,
    COHERENT,
    INCOHERENT,
    ComplexArray,
    FloatArray,
    sampled_covariance,
)
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER


def some_state(seed: int, n_targets: int = 3) -> KalmanState:
    """Return a state whose targets are correlated."""
    generator = np.random.default_rng(seed)
    root = generator.standard_normal((2 * n_targets, 2 * n_targets))
    return KalmanState(generator.standard_normal(2 * n_targets), root @ root.T)


def linear_fit(offset: FloatArray, information: FloatArray) -> SubspaceFit:
    """Return the score at an offset before the peak of a quadratic log-likelihood."""
    likelihood = np.asarray(-0.5 * offset @ information @ offset)
    return SubspaceFit(likelihood, score=information @ offset, information=information)


@pytest.mark.parametrize("age", [0.0, 0.4])
def test_linear_block_is_a_kalman_update(age: float) -> None:
    state = some_state(1)
    generator = np.random.default_rng(2)
    root = generator.standard_normal((3, 3))
    information, measured = root @ root.T + np.eye(3), generator.standard_normal(3)
    updated = update_jointly(state, age, lambda at: linear_fit(measured - at, information)).state
    matrix = np.asarray(np.kron([[1.0, -age]], np.eye(3)), dtype=np.float64)
    noise = np.asarray(np.linalg.inv(information), dtype=np.float64)
    expected = update(state, measured, matrix, noise).state
    assert np.allclose(updated.mean, expected.mean)
    assert np.allclose(updated.covariance, expected.covariance)


def test_prediction_is_that_of_every_target() -> None:
    each = KalmanState(
        np.array([[0.1, 0.01], [0.3, -0.02]]), np.array([np.diag([4.0, 1.0]), np.eye(2)])
    )
    joint = KalmanState(each.mean.T.reshape(4), np.diag([4.0, 1.0, 1.0, 1.0]))
    predicted = predict_jointly(joint, 2.0, 0.5)
    expected = predict(each, transition_matrix(2.0), process_noise_matrix(0.5, 2.0))
    assert np.allclose(predicted.mean.reshape(2, 2).T, expected.mean)
    for target in range(2):
        rows = [target, target + 2]
        assert np.allclose(predicted.covariance[np.ix_(rows, rows)], expected.covariance[target])
    assert predicted.covariance[0, 1] == 0.0


def test_block_that_says_nothing_leaves_the_prior() -> None:
    state = some_state(3)
    nothing = SubspaceFit(np.zeros(()), score=np.zeros(3), information=np.zeros((3, 3)))
    updated = update_jointly(state, 0.5, lambda at: nothing).state
    assert np.allclose(updated.mean, state.mean)
    assert np.allclose(updated.covariance, state.covariance)


def test_singular_information_moves_only_what_it_is_about() -> None:
    # Of two targets at one place a block tells only where both are.
    state = KalmanState(np.array([0.1, 0.1, 0.0, 0.0]), 1e-4 * np.eye(4))
    information = 1e6 * np.ones((2, 2))
    updated = update_jointly(
        state, 0.0, lambda at: linear_fit(np.array([0.11, 0.11]) - at, information)
    ).state
    assert np.allclose(updated.mean[:2], 0.11, atol=1e-4)
    sum_of_both, difference = np.array([1.0, 1.0, 0.0, 0.0]), np.array([1.0, -1.0, 0.0, 0.0])
    assert sum_of_both @ updated.covariance @ sum_of_both < 1e-5
    assert difference @ updated.covariance @ difference == pytest.approx(2e-4)


@pytest.mark.parametrize("separation_deg", [0.0, 0.01, 3.0])
def test_covariance_stays_one_and_shrinks(separation_deg: float) -> None:
    subspace = signal_subspace(sampled_covariance(4, INCOHERENT, n_snapshots=200), 2)
    angles = np.deg2rad([-4.0, -4.0 + separation_deg])
    state = KalmanState(np.append(angles, [0.0, 0.0]), np.diag([1e-3, 1e-3, 1e-4, 1e-4]))
    updated = update_jointly(
        state, 0.5, lambda at: weighted_subspace_fit(subspace, 200, POSITIONS, at, WAVENUMBER)
    ).state
    assert np.isfinite(updated.mean).all()
    assert np.array_equal(updated.covariance, updated.covariance.T)
    assert np.linalg.eigvalsh(updated.covariance)[0] > 0.0
    removed = np.linalg.eigvalsh(state.covariance - updated.covariance)
    assert removed[0] > -1e-12


@pytest.mark.parametrize(("sources", "rank"), [(INCOHERENT, 2), (COHERENT, 1)])
def test_vague_prior_gives_the_angles_of_the_block(sources: ComplexArray, rank: int) -> None:
    subspace = signal_subspace(sampled_covariance(5, sources, n_snapshots=2000), rank)
    state = KalmanState(np.append(ANGLES + 0.01, [0.0, 0.0]), 0.02**2 * np.eye(4))
    for _ in range(3):
        vague = KalmanState(state.mean, 0.02**2 * np.eye(4))
        state = update_jointly(
            vague, 0.0, lambda at: weighted_subspace_fit(subspace, 2000, POSITIONS, at, WAVENUMBER)
        ).state
    errors = state.mean[:2] - ANGLES
    assert np.all(np.abs(errors) < 4.0 * np.sqrt(np.diag(state.covariance)[:2]))


def test_order_of_the_targets_does_not_matter() -> None:
    subspace = signal_subspace(sampled_covariance(6, INCOHERENT), 2)
    state = some_state(7, 2)
    state = KalmanState(
        np.append(ANGLES + np.array([0.01, -0.02]), [0.01, 0.0]), 1e-4 * state.covariance
    )
    order = np.array([1, 0, 3, 2])
    swapped = KalmanState(state.mean[order], state.covariance[np.ix_(order, order)])

    def fit(at: FloatArray) -> SubspaceFit:
        return weighted_subspace_fit(subspace, 64, POSITIONS, at, WAVENUMBER)

    one, other = update_jointly(state, 0.3, fit), update_jointly(swapped, 0.3, fit)
    first, second = one.state, other.state
    assert one.log_evidence == pytest.approx(float(other.log_evidence))
    assert np.allclose(first.mean[order], second.mean, atol=1e-12)
    assert np.allclose(first.covariance[np.ix_(order, order)], second.covariance, atol=1e-12)


def test_evidence_is_the_probability_of_a_linear_block_under_its_prediction() -> None:
    state = some_state(8)
    root = np.random.default_rng(9).standard_normal((3, 3))
    information = root @ root.T + np.eye(3)
    spread = state.covariance[:3, :3] + np.linalg.inv(information)
    evidences, expected = [], []
    for measured in np.random.default_rng(10).standard_normal((2, 3)):

        def fit(at: FloatArray, measured: FloatArray = measured) -> SubspaceFit:
            return linear_fit(measured - at, information)

        evidences.append(float(update_jointly(state, 0.0, fit).log_evidence))
        innovation = measured - state.mean[:3]
        expected.append(-0.5 * innovation @ np.linalg.solve(spread, innovation))
    # But for what does not depend on the measurement.
    assert evidences[1] - evidences[0] == pytest.approx(expected[1] - expected[0])
