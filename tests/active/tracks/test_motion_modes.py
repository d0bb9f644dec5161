"""Protects: mixing keeps the mean, turns keep the speed and follow the circle."""

import numpy as np
import pytest

from sonar_tracking.active.tracks.motion_modes import (
    MotionModes,
    turn_matrices,
    white_acceleration_noise,
)
from sonar_tracking.active.tracks.track_bank import predict_bank
from tests.active.track_scene import bank_of


def test_modes_mix_without_changing_the_mean() -> None:
    modes = MotionModes(3, 0.0, 0.01, 0.05, 0.8, initial_speed_deviation=8.0)
    bank = bank_of([[100.0, 200.0]], 3)
    still = predict_bank(bank, modes, 0.0, 1.0)
    assert still.moments()[0] == pytest.approx(bank.moments()[0])
    assert still.moments()[1] == pytest.approx(bank.moments()[1])
    assert np.sum(still.mode_probability) == pytest.approx(1.0)
    assert modes.mode_prior @ modes.mode_transition == pytest.approx(modes.mode_prior)


def test_turns_keep_the_speed_and_follow_the_circle() -> None:
    rate, interval = 0.005, 10.0
    state = np.array([0.0, 0.0, 2.0, 0.0])
    turned = turn_matrices(np.array(rate), interval) @ state
    radius = 2.0 / rate
    angle = rate * interval
    assert np.hypot(*turned[2:]) == pytest.approx(2.0)
    assert turned[:2] == pytest.approx([radius * np.sin(angle), radius * (1.0 - np.cos(angle))])
    straight = turn_matrices(np.array(0.0), interval) @ state
    assert straight == pytest.approx([20.0, 0.0, 2.0, 0.0])


def test_modes_change_with_their_probabilities() -> None:
    modes = MotionModes(3, 0.0, 0.01, 0.06, 0.8, initial_speed_deviation=8.0)
    expected = [[0.94, 0.03, 0.03], [0.2, 0.8, 0.0], [0.2, 0.0, 0.8]]
    assert modes.mode_transition == pytest.approx(np.array(expected))
    # In the long run as many turns begin (0.03 of the straight ones) as end (0.2 of them).
    assert modes.mode_prior == pytest.approx(np.array([1.0, 0.15, 0.15]) / 1.3)
    single = MotionModes(1, 0.0, initial_speed_deviation=8.0)
    assert single.mode_transition.tolist() == [[1.0]]
    assert single.mode_prior.tolist() == [1.0]


def test_the_turn_rate_is_the_lateral_acceleration_over_the_speed() -> None:
    modes = MotionModes(3, 0.0, 0.012, initial_speed_deviation=8.0)
    velocity = np.array([[3.0, 4.0], [0.0, 0.3], [0.0, 0.1]])
    rates = modes.turn_rates(np.repeat(velocity[:, None], 3, axis=1))
    # Below 0.3 m/s the rate does not grow any more. Left is positive.
    assert rates == pytest.approx(np.outer([0.0024, 0.04, 0.04], [0.0, 1.0, -1.0]))
    assert MotionModes(1, 0.0, 0.012, initial_speed_deviation=8.0).turn_rates(
        np.array([[3.0, 4.0]])
    ).tolist() == [0.0]


@pytest.mark.parametrize("rate", [0.01, -0.02, 1e-9, 0.0])
def test_a_turn_moves_any_state_on_its_circle(rate: float) -> None:
    """By complex numbers: the velocity turns, the position is its integral."""
    interval, position, velocity = 13.0, 100.0 - 50.0j, 3.0 + 4.0j
    turned = velocity * np.exp(1j * rate * interval)
    travelled = velocity * interval if rate == 0.0 else (turned - velocity) / (1j * rate)
    state = turn_matrices(np.array(rate), interval) @ np.array(
        [position.real, position.imag, velocity.real, velocity.imag]
    )
    assert complex(state[0], state[1]) == pytest.approx(position + travelled, rel=1e-6)
    assert complex(state[2], state[3]) == pytest.approx(turned)


def test_noise_is_one_acceleration_over_the_interval() -> None:
    noise = white_acceleration_noise(0.1, 4.0)
    expected = 0.01 * np.array(
        [
            [64.0, 0.0, 32.0, 0.0],
            [0.0, 64.0, 0.0, 32.0],
            [32.0, 0.0, 16.0, 0.0],
            [0.0, 32.0, 0.0, 16.0],
        ]
    )
    assert noise == pytest.approx(expected)
    with pytest.raises(ValueError, match="read-only"):
        noise[0, 0] = 1.0
