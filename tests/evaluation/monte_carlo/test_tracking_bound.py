"""Protects: the tracking bound is the Riccati recursion, couples targets, and bears a crossing."""

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.tracking_bound import tracking_bound

PERIOD = 1.0
TRANSITION = np.array([[1.0, PERIOD], [0.0, 1.0]])
PROCESS_NOISE = 0.01 * np.array([[1 / 3, 1 / 2], [1 / 2, 1.0]])
INITIAL = np.diag([6.0, 1.0])


def test_independent_targets_give_the_kalman_filter_of_one_target() -> None:
    variances = np.array([2.0, 0.3])
    bound = tracking_bound(
        np.broadcast_to(np.diag(1 / variances), (25, 2, 2)), TRANSITION, PROCESS_NOISE, INITIAL
    )
    for target, variance in enumerate(variances):
        covariance = INITIAL
        for step in range(25):
            covariance = TRANSITION @ covariance @ TRANSITION.T + PROCESS_NOISE
            gain = covariance[:, 0] / (covariance[0, 0] + variance)
            covariance = covariance - np.outer(gain, covariance[0])
            assert bound[step, target] == pytest.approx(covariance[0, 0], rel=1e-10)


def test_coupled_targets_are_harder_than_the_same_targets_alone() -> None:
    coupled = np.array([[2.0, 1.9], [1.9, 2.0]])
    together = tracking_bound(
        np.broadcast_to(coupled, (9, 2, 2)), TRANSITION, PROCESS_NOISE, INITIAL
    )
    alone = tracking_bound(
        np.broadcast_to(np.diag([2.0, 2.0]), (9, 2, 2)), TRANSITION, PROCESS_NOISE, INITIAL
    )
    assert np.all(together > alone)


def test_a_crossing_without_separate_information_keeps_the_bound_finite() -> None:
    information = np.broadcast_to(np.eye(2), (9, 2, 2)).copy()
    information[4] = [[1.0, 1.0], [1.0, 1.0]]
    information[5] = 0.0
    bound = tracking_bound(information, TRANSITION, PROCESS_NOISE, INITIAL)
    assert np.all(np.isfinite(bound)) and np.all(bound > 0)
    assert np.all(bound[5] > bound[4])
