"""Which mode of process noise a bearing needs is found out, whatever the time between data."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.motion_modes import (
    N_MODES,
    MotionModes,
    mode_densities,
    passing_process_noise,
    turning_back_process_noise,
    undecided,
)
from sonar_tracking.records.arrays import FloatArray

DENSITIES = mode_densities(1e-6, 0.1)
ONE = np.array([True])


def target(angle: float = 0.0, rate: float = 0.0) -> KalmanState:
    return KalmanState(np.array([[angle, rate]]), np.array([np.diag([1.0, 0.01])]))


def followed(
    measured: FloatArray, interval: float, deviation: float
) -> tuple[MotionModes, FloatArray]:
    """Return the modes after measurements of one target, and its NEES at angle zero."""
    modes, errors = undecided(target(), N_MODES), []
    for angle in measured:
        modes, _ = modes.predict(interval, np.broadcast_to(DENSITIES, (1, N_MODES)))
        modes = modes.update(np.array([angle]), np.array([deviation**2]), 0.0, ONE)
        state = modes.combined()
        errors.append(state.mean[0, 0] ** 2 / state.covariance[0, 0, 0])
    return modes, np.array(errors)


def test_modes_go_from_the_steady_noise_to_the_full_one_in_equal_ratios() -> None:
    assert DENSITIES[[0, -1]] == pytest.approx([1e-6, 0.1])
    assert np.ptp(DENSITIES[1:] / DENSITIES[:-1]) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("interval", "deviation", "share"), [(0.5, 0.3, 0.2), (2.0, 0.2, 0.3), (8.0, 0.15, 0.45)]
)
def test_a_steady_bearing_is_known_as_one_whatever_the_interval(
    interval: float, deviation: float, share: float
) -> None:
    errors = deviation * np.random.default_rng(1).standard_normal(80)
    modes, nees = followed(errors, interval, deviation)
    # With 1e-6 deg^2/s^3 it is 0.42 of the variance of one measurement every 8 s in the long run.
    assert modes.combined().covariance[0, 0, 0] < share * deviation**2
    assert modes.probability[0, -1] < 0.02
    assert nees[20:].mean() < 2.5


def test_a_turn_is_followed_and_forgotten_again() -> None:
    times = 0.5 * np.arange(240)
    turning = (times > 40.0) & (times < 60.0)
    angle = np.where(turning, 5.0 * np.sin(0.6 * (times - 40.0)), 0.0)
    measured = angle + 0.3 * np.random.default_rng(2).standard_normal(times.size)
    modes, density, errors = undecided(target(), N_MODES), [], []
    for now in measured:
        modes, noise = modes.predict(0.5, np.broadcast_to(DENSITIES, (1, N_MODES)))
        modes = modes.update(np.array([now]), np.array([0.09]), 0.0, ONE)
        density.append(noise[0])
        errors.append(modes.combined().mean[0, 0])
    assert max(density[60:80]) < 1e-3 < 0.03 < np.median(density[100:120])
    assert density[-1] < 1e-3
    assert np.std((np.array(errors) - angle)[100:120]) < 0.8


def test_mixing_and_predicting_keep_mean_and_covariance_of_all_modes_together() -> None:
    generator = np.random.default_rng(3)
    roots = generator.standard_normal((2, 1, N_MODES, 2, 2))
    modes = MotionModes(
        generator.standard_normal((1, N_MODES, 2)),
        roots[0] @ np.swapaxes(roots[0], -1, -2),
        np.full((1, N_MODES), 0.25),
    )
    before = modes.combined()
    predicted, density = modes.predict(0.0, np.ones((1, N_MODES)))
    after = predicted.combined()
    assert density == pytest.approx(1.0)
    assert after.mean == pytest.approx(before.mean)
    assert after.covariance == pytest.approx(before.covariance)


def test_a_target_without_a_measurement_stays_as_it_is() -> None:
    modes = undecided(target(0.3, 0.1), N_MODES)
    same = modes.update(np.array([np.nan]), np.array([np.nan]), 0.2, np.array([False]))
    for name in ("mean", "covariance", "probability"):
        assert np.array_equal(getattr(same, name), getattr(modes, name))


def test_targets_come_and_go_and_start_again_in_all_modes() -> None:
    both = undecided(target(0.1), N_MODES).extend(undecided(target(0.2), N_MODES))
    assert both.keep(np.array([1])).combined().mean[0, 0] == pytest.approx(0.2)
    again = both.restarted(
        KalmanState(np.full((2, 2), 0.5), np.stack([np.eye(2)] * 2)), np.array([True, False])
    )
    assert again.mean[0] == pytest.approx(0.5)
    assert np.array_equal(again.mean[1], both.mean[1])


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


def test_turning_back_takes_more_the_faster_two_come_near_each_other() -> None:
    close = np.array([[False, True, False], [True, False, False], [False, False, False]])
    slow, fast = (
        turning_back_process_noise(rate * np.array([1.0, -1.0, 5.0]), close, 0.1)
        for rate in (0.01, 0.02)
    )
    assert fast == pytest.approx(8.0 * slow)
    assert slow[0] == slow[1] > 0.0 == slow[2]
