"""Protects the motion of a target that weaves: moments in closed form against exact integration."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import move_straight
from sonar_tracking.tma.estimators.weaving import Weave, begin_weave, move_deviation

WEAVE = Weave(0.8, 130.0, 0.2)
RATE = 2.0 * np.pi / 130.0


def exactly(elapsed: float, damping: float) -> FloatArray:
    """Return the transition of p, v, d, d' on one axis: p and v are those of the target itself."""
    mean_and_deviation = np.zeros((4, 4))
    mean_and_deviation[0, 1] = 1.0
    mean_and_deviation[2:, 2:] = [[0.0, 1.0], [-(RATE**2), -2.0 * damping * RATE]]
    whole = np.eye(4)
    whole[:2, 2:] = np.eye(2)
    return np.asarray(whole @ expm(mean_and_deviation * elapsed) @ np.linalg.inv(whole))


def moved(
    mean: FloatArray, covariance: FloatArray, elapsed: float, weave: Weave = WEAVE
) -> tuple[FloatArray, FloatArray]:
    """Return a state of 8 and its covariance after a time without other noise."""
    means, covariances = mean[None].copy(), covariance[None].copy()
    move_straight(means, covariances, np.array([elapsed]), np.zeros(1))
    move_deviation(means, covariances, np.array([elapsed]), weave)
    return means[0], covariances[0]


@pytest.mark.parametrize("damping", [0.2, 0.9, 1.0])
@pytest.mark.parametrize("elapsed", [0.0, 0.5, 20.0, 300.0])
def test_a_known_state_moves_as_its_equations_say(elapsed: float, damping: float) -> None:
    state = np.array([100.0, -50.0, 3.0, 1.0, 12.0, -7.0, 0.4, 0.6])
    expected = np.kron(exactly(elapsed, damping), np.eye(2)) @ state
    weave = Weave(0.8, 130.0, damping)
    mean, covariance = moved(state, np.zeros((8, 8)), elapsed, weave)
    assert mean == pytest.approx(expected)
    assert covariance == pytest.approx(covariance.T)
    assert np.linalg.eigvalsh(covariance)[0] > -1e-9


def test_what_begins_to_deviate_is_where_it_was() -> None:
    """80 m in a period of 2 pi 100 s: a tenth of it each second."""
    covariance = np.zeros((8, 8))
    begin_weave(covariance, Weave(0.8, 200.0 * np.pi, 0.2))
    assert covariance == pytest.approx(np.diag([0.0] * 4 + [6400.0, 6400.0, 0.64, 0.64]))


def test_the_deviation_stays_as_large_as_it_is() -> None:
    """About a mean course that is known for certain it is the target that deviates."""
    begun = np.zeros((8, 8))
    begin_weave(begun, WEAVE)
    covariance = np.tile(begun[4:, 4:], (2, 2))
    _, later = moved(np.zeros(8), covariance, 40.0)
    assert later == pytest.approx(covariance, abs=1e-9)


def test_one_step_is_many_short_ones() -> None:
    generator = np.random.default_rng(3)
    root = generator.standard_normal((8, 8))
    mean, covariance = generator.standard_normal(8), root @ root.T
    once = moved(mean, covariance, 60.0)
    often = mean, covariance
    for _ in range(30):
        often = moved(*often, 2.0)
    for one, other in zip(once, often, strict=True):
        assert other == pytest.approx(one, rel=1e-7, abs=1e-7)


def test_without_a_deviation_a_target_goes_straight() -> None:
    still = Weave(0.0, 130.0, 0.2)
    mean, covariance = np.zeros((1, 8)), np.zeros((1, 8, 8))
    mean[0, :4], covariance[0, :4, :4] = [5.0, 6.0, 1.0, 2.0], np.diag([9.0, 9.0, 1.0, 1.0])
    move_straight(mean, covariance, np.array([10.0]), np.zeros(1))
    before = mean.copy(), covariance.copy()
    begin_weave(covariance, still)
    move_deviation(mean, covariance, np.array([10.0]), still)
    assert mean == pytest.approx(before[0])
    assert covariance == pytest.approx(before[1])
