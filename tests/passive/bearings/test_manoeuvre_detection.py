"""Levels of process noise: steady bearings stay steady, turns are found out and followed."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict, update
from sonar_tracking.passive.bearings.manoeuvre_detection import (
    HIGHEST_LEVEL,
    Manoeuvres,
    passing_process_noise,
    steady,
)
from tests.passive.crossing_scene import FloatArray

MATRIX = np.array([[1.0, 0.0]])
DENSITY = 1e-3


def levels_of(measurements: FloatArray, interval: float, variance: float) -> FloatArray:
    """Return the levels, (n_steps, n_targets), of steady filters of measured angles (deg)."""
    n_targets = measurements.shape[1]
    start = np.stack([measurements[0], np.zeros(n_targets)], axis=-1)
    spread = np.diag([variance, 0.04])
    state = KalmanState(start, np.broadcast_to(spread, (n_targets, 2, 2)))
    manoeuvres, levels = steady((n_targets,)), []
    for measured in measurements[1:]:
        before = predict(
            state, transition_matrix(interval), process_noise_matrix(DENSITY, interval)
        )
        state = update(before, measured[:, None], MATRIX, np.array([[variance]])).state
        resolved = np.ones(n_targets, dtype=bool)
        manoeuvres = manoeuvres.update(before, state, 0.0, interval, resolved)
        levels.append(manoeuvres.level)
    return np.array(levels)


@pytest.mark.parametrize("interval", [0.5, 1.0])
def test_steady_bearings_are_rarely_taken_for_turning(interval: float) -> None:
    generator = np.random.default_rng(1)
    times = interval * np.arange(400)[:, None]
    angles = 0.1 * times + 0.25 * generator.standard_normal((400, 50))
    raised = levels_of(angles, interval, 0.25**2) > 0
    assert raised.mean() < 0.05


def test_a_turn_is_found_out_within_seconds() -> None:
    generator = np.random.default_rng(2)
    times = 0.5 * np.arange(100)[:, None]
    turn = 0.25 * np.maximum(times - 30.0, 0.0) ** 2
    levels = levels_of(turn + 0.25 * generator.standard_normal((100, 50)), 0.5, 0.25**2)
    assert (levels[:58] > 0).mean() < 0.05
    assert (levels[68:] > 0).mean() > 0.95
    assert levels.max() == HIGHEST_LEVEL


def test_what_the_array_does_not_resolve_is_held() -> None:
    before = KalmanState(np.zeros((2, 2)), np.broadcast_to(np.eye(2), (2, 2, 2)))
    after = KalmanState(np.full((2, 2), 5.0), 0.5 * before.covariance)
    held = Manoeuvres(np.array([1.0, -1.0]), np.array([1, 0]), np.zeros(2, dtype=bool))
    told = held.update(before, after, 0.0, 1.0, np.array([False, True]))
    assert (told.deviation[0], told.level[0]) == (1.0, 1)
    assert told.level[1] == 1
    assert told.held.tolist() == [True, False]
    assert np.isfinite(told.deviation).all()


def test_an_update_that_tells_nothing_changes_nothing() -> None:
    state = KalmanState(np.zeros((1, 2)), np.eye(2)[None])
    held = Manoeuvres(np.array([2.5]), np.array([1]), np.array([False]))
    told = held.update(state, state, 0.0, 1.0, np.array([True]))
    assert (told.deviation[0], told.level[0]) == (2.5, 1)


def test_new_targets_are_steady_and_rows_follow_their_targets() -> None:
    grown = Manoeuvres(np.array([3.0]), np.array([2]), np.array([True])).extend(2)
    assert grown.level.tolist() == [2, 0, 0]
    assert grown.held.tolist() == [True, False, False]
    assert grown.keep(np.array([1, 0])).deviation.tolist() == [0.0, 3.0]


def test_passing_needs_noise_like_the_cube_of_the_rate() -> None:
    # 2 deg/s: 0.125 * 2^3 = 1 deg^3/s^3, one of the three degrees in radians: pi / 180 deg^2/s^3.
    density = np.rad2deg(np.rad2deg(passing_process_noise(np.deg2rad([2.0, -2.0, 0.2, 0.0]))))
    assert density == pytest.approx(np.pi / 180.0 * np.array([1.0, 1.0, 1e-3, 0.0]))


def test_a_straight_course_at_any_scale_stays_within_that_noise() -> None:
    # Up to 45 degrees from the closest point, the acceleration would change the rate in the time
    # 1 / rate by no more than six standard deviations of the noise; over one where it turns most.
    angle = np.linspace(-np.pi / 4.0, np.pi / 4.0, 201)
    for fastest in (0.001, 0.05):
        rate = fastest * np.cos(angle) ** 2
        change = np.abs(2.0 * rate**2 * np.tan(angle)) / rate
        deviation = np.sqrt(passing_process_noise(rate) / rate)
        assert 1.0 < (change / deviation).max() < 6.0


def updated(
    deviation: float, level: int, change: float, resolved: bool = True, interval: float = 0.5
) -> tuple[float, int, bool]:
    """Return mean, level and "held" after a change of so many standard deviations, age 0."""
    before = KalmanState(np.array([[0.1, 0.0]]), np.array([np.diag([4.0, 1.0])]))
    after = KalmanState(
        np.array([[0.1 + change * np.sqrt(3.0), 0.0]]), np.array([np.diag([1.0, 1.0])])
    )
    manoeuvres = Manoeuvres(np.array([deviation]), np.array([level]), np.array([False]))
    found = manoeuvres.update(before, after, 0.0, interval, np.array([resolved]))
    return float(found.deviation[0]), int(found.level[0]), bool(found.held[0])


@pytest.mark.parametrize("interval", [0.5, 2.5])
def test_the_mean_forgets_with_two_and_a_half_seconds(interval: float) -> None:
    share = np.exp(-interval / 2.5)
    mean, level, held = updated(1.0, 0, -0.7, interval=interval)
    assert mean == pytest.approx(share - 0.7 * np.sqrt(1.0 - share**2))
    assert (level, held) == (0, False)


@pytest.mark.parametrize(
    ("deviation", "level", "change", "expected"),
    [
        (3.3, 0, 0.54, (2.0, 1)),  # 0.819 * 3.3 + 0.574 * 0.54 = 3.012: beyond 3
        (3.3, 0, 0.50, (2.989, 0)),
        (-3.3, 1, -0.54, (-2.0, 2)),
        (3.3, 2, 0.54, (3.012, 2)),  # no higher level
        (0.0, 1, 1.22, (0.700, 0)),  # 0.70^2 < 0.5
        (0.0, 1, 1.25, (0.718, 1)),  # 0.718^2 = 0.515
        (0.0, 2, -1.22, (-0.700, 1)),
        (0.0, 0, 0.0, (0.0, 0)),
    ],
)
def test_levels_rise_beyond_three_deviations_and_fall_below_the_root_of_a_half(
    deviation: float, level: int, change: float, expected: tuple[float, int]
) -> None:
    mean, found, _ = updated(deviation, level, change)
    assert (mean, found) == (pytest.approx(expected[0], abs=2e-3), expected[1])
    assert updated(deviation, level, change, resolved=False) == (deviation, level, True)


def test_the_change_is_that_at_the_instant_of_the_measurement() -> None:
    """Half a second ago the angle was less by half a second of the rate."""
    before = KalmanState(np.array([[0.1, 0.2]]), np.array([[[4.0, 1.0], [1.0, 2.0]]]))
    after = KalmanState(np.array([[0.3, 0.1]]), np.array([[[2.0, 0.5], [0.5, 1.0]]]))
    found = steady((1,)).update(before, after, 0.5, 1e9, np.array([True]))
    change = 0.2 - 0.5 * -0.1
    decrease = (4.0 - 1.0 + 0.5) - (2.0 - 0.5 + 0.25)
    assert found.deviation[0] == pytest.approx(change / np.sqrt(decrease))
