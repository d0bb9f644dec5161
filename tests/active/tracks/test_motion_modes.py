"""Protects: mixing keeps the mean, turns keep the speed and follow the circle."""

import numpy as np
import pytest

from sonar_tracking.active.tracks.motion_modes import MotionModes, turn_matrices
from sonar_tracking.active.tracks.track_bank import predict_bank
from tests.active.track_scene import bank_of


def test_modes_mix_without_changing_the_mean() -> None:
    modes = MotionModes(3, 0.0, 0.01, 0.05, 0.8)
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
