"""Protects the exact split of one large filter into one filter a target."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.alignment.aligned_targets import (
    MOTION,
    AlignedTargets,
    MotionStrengths,
    begun,
    joined,
    predicted,
    with_array,
)
from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.alignment.shared_alignment import (
    AlignmentInformation,
    information_of,
    log_agreement,
    no_information,
    shared_alignment,
)
from sonar_tracking.alignment.target_updates import updated_by_bearings, updated_by_positions
from sonar_tracking.filtering.kalman import KalmanState, predict, update
from sonar_tracking.records.arrays import FloatArray

STRAIGHT = MotionStrengths(np.array([1e-4]), np.ones(1), 60.0)
PRIOR = np.array([np.radians(2.0) ** 2])
STATES = np.array([[3000.0, 0.0, 2.0, 1.0], [0.0, 4000.0, -3.0, 0.5]])
SPREAD = np.tile(np.diag([900.0, 900.0, 4.0, 4.0]), (2, 1, 1))


def dense() -> KalmanState:
    """Return both targets and their one array in a single filter."""
    covariance = np.zeros((9, 9))
    covariance[:4, :4], covariance[4:8, 4:8], covariance[8, 8] = *SPREAD, PRIOR[0]
    return KalmanState(np.concatenate([*STATES, [0.0]]), covariance)


def dense_bearings(state: KalmanState, azimuth: FloatArray, variance: float) -> KalmanState:
    """Let the single filter take in a bearing of each target, linearised like the others."""
    rows = np.zeros((2, 9))
    expected = np.zeros(2)
    for number in (0, 1):
        x, y = state.mean[4 * number : 4 * number + 2]
        rows[number, 4 * number : 4 * number + 2] = np.array([-y, x]) / (x * x + y * y)
        rows[number, 8] = -1.0
        expected[number] = np.arctan2(y, x) - state.mean[8]
    linear = azimuth - expected + rows @ state.mean
    return update(state, linear, rows, variance * np.eye(2)).state


def test_targets_apart_know_what_one_large_filter_knows() -> None:
    """Bearings far better than the alignment: all that matters is what the targets share."""
    targets, large = begun(STATES, SPREAD, STRAIGHT, PRIOR), dense()
    station, variance = np.zeros(2), np.radians(0.05) ** 2
    azimuth = np.arctan2(STATES[:, 1], STATES[:, 0]) - np.radians(0.3)
    targets, _ = updated_by_bearings(
        targets, Bearings(azimuth, np.full(2, variance), station, array=0)
    )
    large = dense_bearings(large, azimuth, variance)
    step = np.eye(9)
    noise = np.zeros((9, 9))
    for number in (0, 1):
        at = 4 * number
        step[at, at + 2] = step[at + 1, at + 3] = 5.0
        block = np.array([[125.0 / 3.0, 12.5], [12.5, 5.0]])
        noise[at : at + 4, at : at + 4] = 1e-4 * np.kron(block, np.eye(2))
    targets, large = predicted(targets, 5.0, STRAIGHT), predict(large, step, noise)
    position = STATES[:, :2] + 5.0 * STATES[:, 2:] + np.array([[20.0, -10.0], [5.0, 30.0]])
    targets, _ = updated_by_positions(targets, position, np.tile(400.0 * np.eye(2), (2, 1, 1)))
    matrix = np.zeros((4, 9))
    matrix[0, 0] = matrix[1, 1] = matrix[2, 4] = matrix[3, 5] = 1.0
    large = update(large, position.ravel(), matrix, 400.0 * np.eye(4)).state
    seen = shared_alignment(targets, no_information(1), PRIOR)
    assert seen.misalignment[0] == pytest.approx(large.mean[8], rel=1e-6)
    assert seen.misalignment_covariance[0, 0] == pytest.approx(large.covariance[8, 8], rel=1e-6)
    for number in (0, 1):
        own = slice(4 * number, 4 * number + 4)
        np.testing.assert_allclose(seen.mean[number, :MOTION], large.mean[own], rtol=1e-6)
        np.testing.assert_allclose(
            seen.covariance[number, :MOTION, :MOTION],
            large.covariance[own, own],
            rtol=1e-6,
            atol=1e-9,
        )


def test_what_an_ended_target_told_stays() -> None:
    targets = begun(STATES, SPREAD, STRAIGHT, PRIOR)
    azimuth = np.arctan2(STATES[:, 1], STATES[:, 0]) - np.radians(1.0)
    heard = Bearings(azimuth, np.full(2, 1e-6), np.zeros(2), array=0)
    targets, _ = updated_by_bearings(targets, heard)
    both = shared_alignment(targets, no_information(1), PRIOR)
    mean, covariance = targets.rows(np.array([1])).collapsed()
    ended = information_of(mean, covariance, PRIOR)
    left = shared_alignment(targets.rows(np.array([0])), ended, PRIOR)
    np.testing.assert_allclose(left.misalignment, both.misalignment, rtol=1e-9)
    np.testing.assert_allclose(left.mean[0], both.mean[0], rtol=1e-9)


def test_sources_agree_as_much_as_the_integral_of_their_product_says() -> None:
    angles, step = np.linspace(-0.4, 0.4, 20001, retstep=True)
    first = step * np.exp(-0.5 * angles**2 / PRIOR) / np.sqrt(2.0 * np.pi * PRIOR)

    def told(turned: float, deviation: float) -> tuple[AlignmentInformation, FloatArray]:
        weight = np.array([1.0 / deviation**2])
        likelihood = np.exp(weight * (turned * angles - 0.5 * angles**2))
        return AlignmentInformation(weight[None], weight * turned), likelihood

    (one, likely), (other, also_likely) = told(0.03, 0.02), told(-0.02, 0.01)
    both = np.sum(first * likely * also_likely)
    by_hand = np.log(both / (np.sum(first * likely) * np.sum(first * also_likely)))
    assert log_agreement(one, other, PRIOR) == pytest.approx(by_hand, rel=1e-6)
    assert log_agreement(one, no_information(1), PRIOR) == pytest.approx(0.0, abs=1e-12)


def test_an_array_that_nobody_has_heard_of_changes_nothing() -> None:
    targets = begun(STATES, SPREAD, STRAIGHT, PRIOR)
    azimuth = np.arctan2(STATES[:, 1], STATES[:, 0]) + 0.01
    heard = Bearings(azimuth, np.full(2, 1e-5), np.zeros(2), array=0)
    targets, _ = updated_by_bearings(targets, heard)
    more = with_array(targets, PRIOR[0])
    one = shared_alignment(targets, no_information(1), PRIOR)
    two = shared_alignment(more, no_information(2), np.tile(PRIOR, 2))
    np.testing.assert_allclose(two.misalignment, [one.misalignment[0], 0.0], atol=1e-12)
    np.testing.assert_allclose(two.mean[:, :5], one.mean, rtol=1e-12)


def test_modes_keep_the_moments_of_their_mixture() -> None:
    """Mixed with their own shares, modes alike stay alike: one step is that of a single mode."""
    strengths = MotionStrengths(np.array([1e-3, 1e-3]), np.array([0.8, 0.2]), 30.0)
    two = predicted(begun(STATES, SPREAD, strengths, PRIOR), 7.0, strengths)
    alone = MotionStrengths(np.array([1e-3]), np.ones(1), 30.0)
    one = predicted(begun(STATES, SPREAD, alone, PRIOR), 7.0, alone)
    np.testing.assert_allclose(two.collapsed()[0], one.collapsed()[0], rtol=1e-12)
    np.testing.assert_allclose(two.collapsed()[1], one.collapsed()[1], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(two.mode, [[0.8, 0.2]] * 2)


def test_the_mode_follows_what_targets_do() -> None:
    strengths = MotionStrengths(np.array([1e-6, 1.0]), np.array([0.95, 0.05]), 60.0)
    targets = joined(
        begun(STATES[:1], SPREAD[:1], strengths, PRIOR),
        begun(STATES[1:], SPREAD[1:], strengths, PRIOR),
    )
    truth = STATES.copy()
    for number in range(12):
        targets = predicted(targets, 5.0, strengths)
        truth[:, :2] += 5.0 * truth[:, 2:]
        if number >= 6:
            truth[1, 2] += 4.0
        noise = np.tile(25.0 * np.eye(2), (2, 1, 1))
        targets, _ = updated_by_positions(targets, truth[:, :2], noise)
    assert targets.mode[0, 0] > 0.9 and targets.mode[1, 1] > 0.9


def near_axis(azimuth_deg: float, deviation_deg: float) -> AlignedTargets:
    """Return a ship 5 km along the axis of an array, known across it to a deviation."""
    state = np.array([[5000.0, 5000.0 * np.tan(np.radians(azimuth_deg)), 0.0, 0.0]])
    across = (5000.0 * np.radians(deviation_deg)) ** 2
    return begun(state, np.diag([900.0, across, 1.0, 1.0])[None], STRAIGHT, np.array([1e-12]))


def test_near_the_axis_of_an_array_either_side_may_be_meant() -> None:
    """A ship 1 degree off the axis, known to 3 degrees: it is on the axis, give or take 2.

    The gain is 3^2 / (3^2 + 0.5^2 + 2^2).
    """
    variance = np.radians([0.5]) ** 2
    near, other = np.radians([2.0]), np.radians([-2.0])
    heard = Bearings(near, variance, np.zeros(2), array=0, other_side=other)
    both, _ = updated_by_bearings(near_axis(1.0, 3.0), heard)
    azimuth = np.degrees(np.arctan2(both.mean[0, 0, 1], both.mean[0, 0, 0]))
    gain = 9.0 / 13.25
    assert azimuth == pytest.approx(1.0 - gain, rel=0.02)
    left = np.degrees(np.sqrt(both.covariance[0, 0, 1, 1]) / 5000.0)
    assert left == pytest.approx(3.0 * np.sqrt(1.0 - gain), rel=0.02)


def test_many_bearings_of_either_side_make_no_side_certain() -> None:
    """Half the angle between the sides is an error that lasts: a hundred bearings are as one."""
    target = near_axis(0.5, 3.0)
    for number in range(100):
        gap = np.radians(2.0 + 0.3 * np.cos(number))
        variance = np.radians([0.3]) ** 2
        heard = Bearings(np.array([gap]), variance, np.zeros(2), array=0, other_side=-gap[None])
        target, _ = updated_by_bearings(target, heard)
    azimuth = np.degrees(np.arctan2(target.mean[0, 0, 1], target.mean[0, 0, 0]))
    left = np.degrees(np.sqrt(target.covariance[0, 0, 1, 1]) / 5000.0)
    assert left > 1.0 and abs(2.0 - azimuth) < 2.0 * left and abs(-2.0 - azimuth) < 2.0 * left


def test_away_from_the_axis_the_other_side_does_not_count() -> None:
    targets = begun(STATES, SPREAD, STRAIGHT, PRIOR)
    azimuth = np.arctan2(STATES[:, 1], STATES[:, 0]) + 0.002
    variance = np.full(2, 1e-5)
    sided = Bearings(azimuth, variance, np.zeros(2), array=0, other_side=azimuth + 1.5)
    both, _ = updated_by_bearings(targets, sided)
    alone, _ = updated_by_bearings(targets, Bearings(azimuth, variance, np.zeros(2), array=0))
    np.testing.assert_allclose(both.mean, alone.mean, rtol=1e-12)
    np.testing.assert_allclose(both.covariance, alone.covariance, rtol=1e-9, atol=1e-12)
