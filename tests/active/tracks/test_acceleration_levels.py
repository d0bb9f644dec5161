"""Protects the modes of the default tracker: intervals do not matter, rates are learnt."""

import numpy as np
import pytest

from sonar_tracking.active.tracks.acceleration_levels import (
    ACCELERATIONS,
    COMPANY,
    EXPECTED_CHANGES,
    EXPECTED_TIME,
    GENTLE,
    STATIC,
    STRAIGHT,
    TURNING,
    AccelerationLevels,
)

MODES = AccelerationLevels(8.0)
N_MODES = MODES.n_modes
FAST = np.full((N_MODES, 2), 20.0)
FAST[[GENTLE, TURNING]] = 0.0
"""Velocity of each mode: the agile one may turn, what curves has no course yet, m/s."""
NOTHING = np.zeros((2, N_MODES))
NEW = NOTHING[:1], NOTHING[:1], NOTHING


def test_the_probabilities_are_probabilities() -> None:
    assert np.sum(MODES.mode_prior) == pytest.approx(1.0)
    assert len(MODES.mode_prior) == N_MODES == 5
    for interval in (0.5, 10.0, 60.0, 1e5):
        (transition,) = MODES.transition(interval, *NEW)
        assert np.sum(transition, axis=1) == pytest.approx(np.ones(N_MODES))
        assert np.min(transition) >= 0.0


def test_a_short_interval_leaves_every_mode_as_it_is() -> None:
    (transition,) = MODES.transition(1e-6, *NEW)
    assert transition == pytest.approx(np.eye(N_MODES), abs=1e-7)
    # Whatever the interval, a mode is left at one rate.
    leaving = [-np.log(np.diagonal(MODES.transition(each, *NEW)[0])) / each for each in (1.0, 30.0)]
    assert leaving[0] == pytest.approx(leaving[1])


def rates(transition: np.ndarray) -> np.ndarray:
    """Return the rates of what goes straight, into turning and agile, over 10 ms, 1/s."""
    return np.asarray(transition[:, STRAIGHT, TURNING:] / 0.01)


def test_turns_begin_at_the_rates_that_the_scene_has_shown() -> None:
    """Mean of a Gamma distribution: changes expected and seen, over time expected and seen."""
    pooled = NOTHING.copy()
    pooled[:, TURNING:] = [[12.0, 5.0], [3000.0, 4000.0]]
    found = rates(MODES.transition(0.01, *NEW[:2], pooled))
    usual = (EXPECTED_CHANGES + pooled[0, TURNING:]) / (EXPECTED_TIME + pooled[1, TURNING:])
    assert found[0] == pytest.approx(usual, rel=1e-3)


def test_a_target_turns_at_its_own_rate_the_more_the_longer_it_is_known() -> None:
    entered, calm = NOTHING.copy(), NOTHING.copy()
    entered[0, TURNING:] = [3.0, 1.0]
    calm[:, TURNING:] = 700.0
    found = rates(MODES.transition(0.01, entered, calm, NOTHING))
    usual = EXPECTED_CHANGES / EXPECTED_TIME
    expected = (COMPANY * usual + entered[:, TURNING:]) / (COMPANY + 700.0)
    assert found == pytest.approx(expected, rel=1e-3)
    assert found[0, 0] > 4.0 * found[1, 0]


def test_what_is_fixed_starts_as_ever_whatever_others_do() -> None:
    pooled = np.full((2, N_MODES), 50.0)
    seen = MODES.transition(10.0, *NEW[:2], pooled)[0, STATIC]
    assert seen == pytest.approx(MODES.transition(10.0, *NEW)[0, STATIC])


def test_what_is_fixed_has_no_velocity_and_stays() -> None:
    state = np.array([100.0, -50.0, 3.0, 4.0])
    matrices = MODES.matrices(np.zeros((1, N_MODES, 2)), 10.0)
    assert (matrices[0] @ state).tolist() == [100.0, -50.0, 0.0, 0.0]
    for matrix in matrices[1:]:
        assert (matrix @ state).tolist() == [130.0, -10.0, 3.0, 4.0]
    noise = MODES.noise(np.zeros((N_MODES, 2)), 100.0)[0]
    assert np.sqrt(np.diag(noise)) == pytest.approx([0.2, 0.2, 0.02, 0.02])


def test_accelerations_are_constant_from_ping_to_ping() -> None:
    """A velocity changes by a T, a position by a T^2 / 2, both by the same acceleration."""
    for acceleration, noise in zip(ACCELERATIONS, MODES.noise(FAST, 2.0)[1:], strict=True):
        step = np.array([2.0 * acceleration, 0.0, 2.0 * acceleration, 0.0])  # T^2 / 2 = T = 2
        other = np.array([0.0, 2.0 * acceleration, 0.0, 2.0 * acceleration])
        expected = np.outer(step, step) + np.outer(other, other)
        assert noise == pytest.approx(expected)


@pytest.mark.parametrize(("mode", "share"), [(GENTLE, 0.2), (TURNING, 0.5)])
def test_what_curves_keeps_its_speed_as_far_as_it_has_a_course(mode: int, share: float) -> None:
    """At 20 m/s a share of the acceleration is along the velocity, at rest it is the same."""
    velocity = np.zeros((2, N_MODES, 2))
    velocity[0, mode] = [12.0, 16.0]
    moving, resting = MODES.noise(velocity, 10.0)[:, mode, 2:, 2:]
    along, across = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    change = 10.0 * ACCELERATIONS[mode - 1]
    assert np.sqrt(along @ moving @ along) == pytest.approx(share * change, rel=0.02)
    assert np.sqrt(across @ moving @ across) == pytest.approx(change)
    assert along @ moving @ across == pytest.approx(0.0, abs=1e-9)
    assert resting == pytest.approx(change**2 * np.eye(2))


def test_a_velocity_changes_by_no_more_than_a_boat_can_turn() -> None:
    agile = MODES.noise(FAST, 60.0)[-1]
    assert np.sqrt(agile[2, 2]) == pytest.approx(15.0)
    assert np.sqrt(agile[0, 0]) == pytest.approx(450.0)


def test_a_slow_ship_does_not_turn_hard() -> None:
    """At 3 m/s a velocity changes by 1 + 3 m/s, at rest by 1 m/s, and in other modes as ever."""
    velocity = np.zeros((2, N_MODES, 2))
    velocity[0, -1] = [1.8, 2.4]
    noise = MODES.noise(velocity, 10.0)
    assert np.sqrt(noise[:, -1, 2, 2]) == pytest.approx([4.0, 1.0])
    assert np.sqrt(noise[:, -1, 1, 1]) == pytest.approx([20.0, 5.0])
    assert noise[:, -1, 0, 2] == pytest.approx([80.0, 5.0])
    assert np.array_equal(noise[0, :-1], MODES.noise(FAST, 10.0)[:-1])


def test_new_targets_are_slow_or_fast() -> None:
    assert MODES.speed_deviation == pytest.approx([0.02, 4.4, 6.0, 6.0, 8.0])
    assert AccelerationLevels(0.01).speed_deviation[0] == 0.01
