"""Protects prior, motion, new lines and the weights of the bank of filters."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    moved_places,
    predict_bank,
    seed_lines,
    start_bank,
    update_bank,
)
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows, keep_rows
from sonar_tracking.tma.estimators.mixture_moments import mixture_moments
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


def random_bank(n_lines: int = 2, batch: tuple[int, ...] = (2,)) -> HypothesisBank:
    """Return runs of three components that lean in all directions."""
    generator = np.random.default_rng(1)
    size = 4 + n_lines
    root = generator.normal(size=(*batch, 3, size, size))
    weight = generator.normal(size=(*batch, 3))
    return HypothesisBank(
        mean=generator.normal(0.0, 100.0, (*batch, 3, size)),
        covariance=root @ np.swapaxes(root, -1, -2),
        log_weight=weight - np.logaddexp.reduce(weight, axis=-1)[..., None],
        known=np.ones((*batch, n_lines), dtype=bool),
    )


def test_places_alone_are_those_of_the_whole_prediction() -> None:
    bank = random_bank(batch=(5,))
    mean, covariance = bank.mean.reshape(15, -1), bank.covariance.reshape(15, 6, 6)
    elapsed, acceleration = np.linspace(0.0, 40.0, 15), np.full(15, 0.2)
    motion, place = moved_places(mean, covariance, elapsed, acceleration**2)
    each = replace(bank, mean=mean[:, None], covariance=covariance[:, None])
    whole = predict_bank(each, elapsed, acceleration)
    np.testing.assert_array_equal(motion, whole.mean[:, 0, :4])
    np.testing.assert_array_equal(place, np.moveaxis(whole.covariance[:, 0, :2, :2], 0, -1))


def test_both_sides_of_a_line_array_have_all_ranges_with_equal_weights() -> None:
    frame = replace(measurement(), azimuth=np.array([0.4, -1.2]), position=np.array([100.0, -50.0]))
    bank = start_bank(frame, EDGES, 20.0)
    middles = [1250.0, 11_000.0]
    expected = [
        [100.0 + reach * np.cos(angle), -50.0 + reach * np.sin(angle)]
        for angle in (0.4, -1.2)
        for reach in middles
    ]
    assert bank.mean[:, :2] == pytest.approx(np.array(expected))
    assert np.all(bank.mean[:, 2:] == 0.0)
    assert np.exp(bank.log_weight) == pytest.approx(np.full(4, 0.25))
    assert bank.covariance[:, 2, 2] == pytest.approx(np.full(4, 400.0 / 3.0))
    assert bank.covariance[:, 3, 3] == pytest.approx(np.full(4, 400.0 / 3.0))
    assert np.all(bank.covariance[:, 4:] == 0.0)
    assert not np.any(bank.known)


def test_prediction_is_f_p_f_and_the_noise_of_white_acceleration() -> None:
    bank = random_bank()
    before = bank.mean.copy(), bank.covariance.copy()
    moved = predict_bank(bank, 3.0, np.array([0.1, 0.4]))
    motion = np.eye(6)
    motion[0, 2] = motion[1, 3] = 3.0
    noise = np.zeros((6, 6))
    noise[:4, :4] = np.kron(np.array([[9.0, 4.5], [4.5, 3.0]]), np.eye(2))
    for run, acceleration in enumerate((0.1, 0.4)):
        for component in range(3):
            assert moved.mean[run, component] == pytest.approx(motion @ bank.mean[run, component])
            spread = motion @ bank.covariance[run, component] @ motion.T
            assert moved.covariance[run, component] == pytest.approx(
                spread + acceleration**2 * noise
            )
    np.testing.assert_array_equal(bank.mean, before[0])
    np.testing.assert_array_equal(bank.covariance, before[1])


def test_rows_one_by_one_are_the_joint_update_and_its_likelihood() -> None:
    bank = random_bank()
    generator = np.random.default_rng(2)
    present = np.broadcast_to(np.array([True, False, True, True]), (2, 3, 4))
    rows = keep_rows(
        LinearisedRows(
            generator.normal(size=(2, 3, 4)),
            generator.normal(size=(2, 3, 4, 6)),
            generator.uniform(0.5, 2.0, (2, 3, 4)),
            present,
        ),
        present,
    )
    penalty = generator.normal(size=(2, 3))
    before = bank.mean.copy(), bank.covariance.copy()
    updated = update_bank(bank, rows, penalty)
    weights = np.zeros((2, 3))
    for run in range(2):
        for component in range(3):
            matrix = rows.derivative[run, component][[0, 2, 3]]
            noise = np.diag(rows.variance[run, component][[0, 2, 3]])
            innovation = rows.innovation[run, component][[0, 2, 3]]
            prior = bank.covariance[run, component]
            spread = matrix @ prior @ matrix.T + noise
            gain = prior @ matrix.T @ np.linalg.inv(spread)
            mean = bank.mean[run, component] + gain @ innovation
            assert updated.mean[run, component] == pytest.approx(mean)
            covariance = prior - gain @ spread @ gain.T
            assert updated.covariance[run, component] == pytest.approx(covariance, abs=1e-9)
            density = -0.5 * innovation @ np.linalg.solve(spread, innovation)
            density -= 0.5 * np.log(np.linalg.det(2.0 * np.pi * spread))
            weights[run, component] = (
                bank.log_weight[run, component] + density + penalty[run, component]
            )
        weights[run] -= np.logaddexp.reduce(weights[run])
    assert updated.log_weight == pytest.approx(weights)
    np.testing.assert_array_equal(bank.mean, before[0])
    np.testing.assert_array_equal(bank.covariance, before[1])


def test_a_line_that_is_seeded_forgets_what_was_known_of_it_and_of_no_other() -> None:
    bank = random_bank(batch=())
    before = bank.mean.copy(), bank.covariance.copy()
    frame = replace(measurement(), velocity=np.zeros(2))
    seeded = seed_lines(bank, frame, np.array([False, True]))
    kept = [0, 1, 2, 3, 4]
    np.testing.assert_array_equal(seeded.mean[:, kept], bank.mean[:, kept])
    for component in range(3):
        block = np.ix_(kept, kept)
        np.testing.assert_array_equal(
            seeded.covariance[component][block], bank.covariance[component][block]
        )
        assert np.all(seeded.covariance[component, 5, kept] == 0.0)
        assert np.all(seeded.covariance[component, kept, 5] == 0.0)
        assert seeded.covariance[component, 5, 5] == pytest.approx((210.0 / 6.0) ** 2)
        rate = bank.mean[component, :2] @ bank.mean[component, 2:4]
        rate /= np.hypot(*bank.mean[component, :2])
        assert seeded.mean[component, 5] == pytest.approx(210.0 / (1.0 - rate / 1500.0))
    np.testing.assert_array_equal(bank.mean, before[0])
    np.testing.assert_array_equal(bank.covariance, before[1])
    assert seed_lines(bank, frame, np.zeros(2, dtype=bool)) is bank
