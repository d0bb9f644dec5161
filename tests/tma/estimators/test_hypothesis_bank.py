"""Protects prior, motion, new lines and the weights of the bank of filters."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    mixture_moments,
    predict_bank,
    seed_lines,
    start_bank,
    update_bank,
)
from sonar_tracking.tma.estimators.recursion import gate_rows, innovation_variance, rows_of
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

EDGES = np.array([500.0, 2000.0, 20_000.0])


def measurement(azimuth: float = 0.4) -> TmaMeasurement:
    return TmaMeasurement(
        stamp=1,
        position=np.zeros(2),
        velocity=np.array([6.0, 0.0]),
        azimuth=np.array([azimuth]),
        azimuth_variance=np.array(np.radians(0.5) ** 2),
        frequency=np.array([300.0, 210.0]),
        frequency_deviation=np.array([1.0, 1.0]),
    )


def test_the_prior_is_uniform_in_range_and_turns_with_the_scene() -> None:
    one = start_bank(measurement(0.0), EDGES, 20.0)
    assert one.mean[:, 0].tolist() == [1250.0, 11_000.0]
    assert one.covariance[0, 0, 0] == pytest.approx(1500.0**2 / 12)
    assert one.covariance[1, 1, 1] == pytest.approx((11_000 * np.radians(0.5)) ** 2)
    assert one.covariance[0, 2, 2] == pytest.approx(20.0**2 / 3)
    angle = 1.234
    turned = start_bank(measurement(angle), EDGES, 20.0)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    expected = rotation @ one.covariance[:, :2, :2] @ rotation.T
    np.testing.assert_allclose(turned.covariance[:, :2, :2], expected, rtol=1e-9, atol=1e-6)


def test_a_prediction_in_two_steps_is_that_in_one() -> None:
    bank = seed_lines(
        start_bank(measurement(), EDGES, 20.0), measurement(), np.array([True, False])
    )
    acceleration = np.array(0.1)
    once = predict_bank(bank, 3.0, acceleration)
    twice = predict_bank(predict_bank(bank, 1.0, acceleration), 2.0, acceleration)
    np.testing.assert_allclose(once.covariance, twice.covariance, rtol=1e-12)
    np.testing.assert_allclose(once.mean, twice.mean, rtol=1e-12)


def test_a_new_line_is_diffuse_and_uncorrelated_until_it_is_used() -> None:
    frame = measurement()
    bank = seed_lines(start_bank(frame, EDGES, 20.0), frame, np.array([True, False]))
    assert bank.known.tolist() == [True, False]
    assert bank.covariance[0, 4, 4] == pytest.approx(50.0**2)
    assert np.all(bank.covariance[0, 4, :4] == 0.0)
    # At rest, the target is neared at the speed of own ship along the line of sight.
    assert bank.mean[0, 4] == pytest.approx(300.0 / (1.0 + 6.0 * np.cos(0.4) / 1500.0))
    updated = update_bank(bank, rows_of(bank, frame), np.zeros(2))
    assert np.any(updated.covariance[0, 4, 2:4] != 0.0)
    assert updated.covariance[0, 5, 5] == 0.0


def test_one_azimuth_does_what_bayes_says() -> None:
    frame = replace(measurement(), frequency=np.full(2, np.nan))
    bank = start_bank(frame, EDGES, 20.0)
    updated = update_bank(bank, rows_of(bank, frame), np.zeros(2))
    across = np.array([-np.sin(0.4), np.cos(0.4)])
    spread = across @ updated.covariance[1, :2, :2] @ across
    assert spread == pytest.approx(0.5 * (11_000 * np.radians(0.5)) ** 2, rel=1e-9)
    np.testing.assert_allclose(np.exp(updated.log_weight), 0.5, rtol=1e-9)


def test_a_hypothesis_gains_nothing_by_refusing_a_measurement() -> None:
    frame = measurement()
    bank = start_bank(frame, EDGES, 20.0)
    elsewhere = bank.mean.copy()
    elsewhere[0, :2] *= -1.0
    bank = replace(bank, mean=elsewhere)
    rows = rows_of(bank, frame)
    rows, penalty = gate_rows(rows, innovation_variance(bank, rows), 4.0)
    assert rows.present[:, 0].tolist() == [False, True]
    updated = update_bank(bank, rows, penalty)
    assert updated.log_weight[0] < updated.log_weight[1] - 5.0


def test_the_moments_hold_the_spread_of_the_means() -> None:
    mean = np.array([[0.0, 0, 0, 0], [10.0, 0, 0, 0]])
    bank = HypothesisBank(
        mean, np.tile(np.eye(4), (2, 1, 1)), np.log([0.25, 0.75]), np.zeros(0, bool)
    )
    centre, covariance = mixture_moments(bank)
    assert centre[0] == pytest.approx(7.5)
    assert covariance[0, 0] == pytest.approx(1.0 + 0.25 * 0.75 * 100.0)
