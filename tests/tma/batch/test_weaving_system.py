"""Protects the smoother's target that weaves: same motion as the filter's, size learnt upwards."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.tma.batch.linear_smoother import LinearSystem, smooth_linear
from sonar_tracking.tma.batch.weaving_system import learn_weave, weaving_system
from sonar_tracking.tma.estimators.weaving import Weave, move_deviation

N = 400
EXPECTED = Weave(0.4, 100.0, 1.0)


def positions_seen(positions: np.ndarray) -> LinearSystem:
    """Return a target that goes straight, whose position is measured to 1 m each second."""
    transition = np.tile(np.eye(4), (N, 1, 1))
    transition[1:, 0, 2] = transition[1:, 1, 3] = 1.0
    matrix = np.tile(np.eye(4)[:2], (N, 1, 1))
    return LinearSystem(
        start=KalmanState(np.zeros(4), np.diag([1e6, 1e6, 100.0, 100.0])),
        transition=transition,
        noise=np.tile(1e-6 * np.eye(4), (N, 1, 1)),
        matrix=matrix,
        measured=positions,
        weight=np.ones((N, 2)),
        variance=np.ones((N, 2)),
        degrees_of_freedom=4.0,
    )


def weaving(speed: float) -> np.ndarray:
    """Return what is measured of a target at 3 m/s whose deviation is a sine, of this speed."""
    generator = np.random.default_rng(1)
    times = np.arange(N, dtype=float)
    rate = 2.0 * np.pi / 100.0
    sine = np.sqrt(2.0) * speed / rate * np.sin(rate * times)
    return np.stack([3.0 * times, sine], axis=1) + generator.standard_normal((N, 2))


def learnt(positions: np.ndarray) -> Weave:
    intervals = np.diff(np.arange(N, dtype=float), prepend=0.0)
    weave, system = EXPECTED, positions_seen(positions)
    for _ in range(10):
        states = smooth_linear(weaving_system(system, intervals, weave))
        weave = learn_weave(states, intervals, weave, EXPECTED)
    return weave


def test_states_move_as_those_of_the_filter_do() -> None:
    intervals = np.diff(np.arange(N, dtype=float), prepend=0.0)
    system = weaving_system(positions_seen(np.zeros((N, 2))), intervals, EXPECTED)
    state = np.array([5.0, 6.0, 1.0, 2.0, 3.0, -4.0, 0.1, 0.2])
    moved = state[None].copy()
    moved[:, :2] += moved[:, 2:4]
    noise = np.zeros((1, 8, 8))
    move_deviation(moved, noise, np.ones(1), EXPECTED)
    assert system.transition[7] @ state == pytest.approx(moved[0])
    assert system.noise[7] == pytest.approx(noise[0] + np.diag([1e-6] * 4 + [0.0] * 4))


def test_a_target_that_weaves_more_than_expected_is_found_to() -> None:
    found = learnt(weaving(2.0)).speed
    assert 0.8 < found < 4.0, "of a sine on one axis"


def test_one_that_does_not_is_taken_to_weave_as_expected() -> None:
    assert learnt(weaving(0.0)) == EXPECTED
