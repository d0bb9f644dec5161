"""Protects the bank of tracks against a plain coding of the interacting multiple models."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from sonar_tracking.active.tracks.motion_modes import MotionModes, turn_matrices
from sonar_tracking.active.tracks.track_bank import (
    TrackBank,
    empty_bank,
    new_target_modes,
    predict_bank,
)
from tests.active.track_scene import bank_of

INTERVAL = 7.0
MODES = MotionModes(3, 0.02, 0.03, 0.1, 0.7, initial_speed_deviation=8.0)


def random_bank(n_modes: int) -> TrackBank:
    """Return two tracks whose modes disagree in everything."""
    generator = np.random.default_rng(n_modes)
    bank = bank_of([[3000.0, 1000.0], [-2000.0, 500.0]], n_modes)
    root = generator.normal(size=(2, n_modes, 4, 4)) * np.array([20.0, 30.0, 1.0, 2.0])[:, None]
    probability = generator.random((2, n_modes)) + 0.1
    return replace(
        bank,
        mean=bank.mean + generator.normal(0.0, [50.0, 40.0, 2.0, 3.0], bank.mean.shape),
        covariance=root @ np.swapaxes(root, -1, -2),
        mode_probability=probability / np.sum(probability, axis=1, keepdims=True),
        existence=np.array([0.5, 0.25]),
    )


def noise() -> np.ndarray:
    """Return sigma^2 G G^T of one acceleration over the interval."""
    gain = np.vstack([0.5 * INTERVAL**2 * np.eye(2), INTERVAL * np.eye(2)])
    return 0.02**2 * gain @ gain.T


def test_moments_are_those_of_the_mixture() -> None:
    bank = random_bank(3)
    mean, covariance = bank.moments()
    for row in range(2):
        expected = sum(
            p * m for p, m in zip(bank.mode_probability[row], bank.mean[row], strict=True)
        )
        spread = np.zeros((4, 4))
        for mode in range(3):
            away = bank.mean[row, mode] - expected
            probability = bank.mode_probability[row, mode]
            spread += probability * (bank.covariance[row, mode] + np.outer(away, away))
        assert mean[row] == pytest.approx(expected)
        assert covariance[row] == pytest.approx(spread)
    single = random_bank(1)
    assert single.moments()[0] == pytest.approx(single.mean[:, 0])
    assert single.moments()[1] == pytest.approx(single.covariance[:, 0])


def test_prediction_is_that_of_interacting_models_one_by_one() -> None:
    bank = random_bank(3)
    predicted = predict_bank(bank, MODES, INTERVAL, 0.9)
    transition = MODES.mode_transition
    for row in range(2):
        before = bank.mode_probability[row]
        for mode in range(3):
            joint = transition[:, mode] * before
            probability = np.sum(joint)
            share = joint / probability
            mean = share @ bank.mean[row]
            covariance = np.zeros((4, 4))
            for other in range(3):
                away = bank.mean[row, other] - mean
                covariance += share[other] * (bank.covariance[row, other] + np.outer(away, away))
            speed = np.hypot(mean[2], mean[3])
            rate = [0.0, 0.03 / speed, -0.03 / speed][mode]
            motion = turn_matrices(np.array(rate), INTERVAL)
            assert predicted.mode_probability[row, mode] == pytest.approx(probability)
            assert predicted.mean[row, mode] == pytest.approx(motion @ mean)
            assert predicted.covariance[row, mode] == pytest.approx(
                motion @ covariance @ motion.T + noise()
            )
    assert predicted.existence == pytest.approx([0.45, 0.225])


def test_one_mode_moves_straight() -> None:
    bank = random_bank(1)
    predicted = predict_bank(bank, MotionModes(1, 0.02, initial_speed_deviation=8.0), INTERVAL, 1.0)
    motion = np.eye(4) + INTERVAL * np.eye(4, k=2)
    for row in range(2):
        assert predicted.mean[row, 0] == pytest.approx(motion @ bank.mean[row, 0])
        spread = motion @ bank.covariance[row, 0] @ motion.T + noise()
        assert predicted.covariance[row, 0] == pytest.approx(spread)
    assert predicted.mode_probability.tolist() == [[1.0], [1.0]]


def test_rows_are_chosen_and_joined_in_all_columns() -> None:
    bank = random_bank(3)
    joined = bank.append(bank.select(np.array([1, 0])))
    assert len(joined) == 4
    assert len(empty_bank(3).append(bank)) == 2
    for field in fields(TrackBank):
        column = getattr(bank, field.name)
        both = np.concatenate([column, column[::-1]])
        np.testing.assert_array_equal(getattr(joined, field.name), both)
        chosen = getattr(bank.select(np.array([False, True])), field.name)
        np.testing.assert_array_equal(chosen, column[1:])


def test_new_targets_are_expected_to_move_as_the_confirmed_ones_do() -> None:
    modes = MotionModes(3, 0.0, 0.01, 0.025, 0.9, initial_speed_deviation=8.0)
    bank = bank_of([[0.0, 0.0]] * 5, 3)
    bank = replace(
        bank,
        mode_probability=np.tile([0.0, 1.0, 0.0], (5, 1)),
        confirmed=np.array([True] * 4 + [False]),
    )
    # The prior counts as much as four tracks.
    assert new_target_modes(bank, modes) == pytest.approx([0.4, 0.55, 0.05])
    assert new_target_modes(empty_bank(3), modes) == pytest.approx(modes.mode_prior)
