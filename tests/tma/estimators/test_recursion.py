"""Protects the steps all estimators share: the side taken, the gate and what refusing costs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, update_bank
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows
from sonar_tracking.tma.estimators.mixture_moments import mixture_moments
from sonar_tracking.tma.estimators.recursion import (
    elapsed,
    estimate_of,
    extended_step,
    gate_rows,
    innovation_variance,
    rows_of,
)
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

GATE = 4.0


def bank_at(*means: list[float]) -> HypothesisBank:
    """Return equally probable components at some states, each with the unit covariance."""
    mean = np.array(means)
    count, size = mean.shape
    weight = np.full(count, -np.log(count))
    return HypothesisBank(
        mean, np.tile(np.eye(size), (count, 1, 1)), weight, np.ones(size - 4, bool)
    )


def azimuth_frame(*azimuths: float) -> TmaMeasurement:
    """Return azimuths measured with 0.01 rad from the origin, at rest."""
    return TmaMeasurement(
        stamp=1,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.array(azimuths),
        azimuth_variance=np.array(1e-4),
    )


def one_row(innovation: float, present: bool = True) -> LinearisedRows:
    """Return one measurement row of one component."""
    return LinearisedRows(
        np.array([[innovation]]),
        np.array([[[1.0, 0.0, 0.0, 0.0]]]),
        np.array([[2.0]]),
        np.array([[present]]),
    )


@pytest.mark.parametrize(("innovation", "outside"), [(19.9, False), (20.1, True), (-20.1, True)])
def test_a_row_beyond_the_gate_is_left_out_at_the_likelihood_of_the_edge(
    innovation: float, outside: bool
) -> None:
    variance = np.array([[25.0]])  # the gate of 4 deviations lies at 20
    kept, penalty = gate_rows(one_row(innovation), variance, GATE)
    assert kept.present[0, 0] == (not outside)
    assert kept.derivative[0, 0, 0] == (0.0 if outside else 1.0)
    # The normal density of variance 25, four deviations from its mean.
    edge = np.log(np.exp(-8.0) / np.sqrt(2.0 * np.pi * 25.0))
    assert penalty[0] == pytest.approx(edge if outside else 0.0)


def test_a_row_that_is_not_there_costs_nothing() -> None:
    _, penalty = gate_rows(one_row(99.0, present=False), np.array([[25.0]]), GATE)
    assert penalty.tolist() == [0.0]


def test_refusing_weighs_as_accepting_at_the_edge_of_the_gate() -> None:
    """What a component loses by an outlier is continuous at the gate, and never more beyond it."""
    two = bank_at([1000.0, 0.0, 0.0, 0.0], [1000.0, 0.0, 0.0, 0.0])
    odds = []
    for deviations in (3.999, 4.001, 50.0):
        rows = rows_of(two, azimuth_frame(0.0))
        variance = innovation_variance(two, rows)
        shifted = rows.innovation.copy()
        shifted[0, 0] += deviations * np.sqrt(variance[0, 0])
        kept, penalty = gate_rows(replace(rows, innovation=shifted), variance, GATE)
        updated = update_bank(two, kept, penalty)
        odds.append(float(np.diff(updated.log_weight)[0]))
    assert odds == pytest.approx([8.0, 8.0, 8.0], abs=0.01)


def test_a_component_takes_the_azimuth_on_its_own_side() -> None:
    sides = bank_at([0.0, 1000.0, 0.0, 0.0], [0.0, -1000.0, 0.0, 0.0], [-1000.0, 1.0, 0.0, 0.0])
    rows = rows_of(sides, azimuth_frame(1.6, -1.5))
    off = [1.6 - np.pi / 2.0, np.pi / 2.0 - 1.5, 1.6 - np.pi + 0.001]
    assert rows.innovation[:2, 0] == pytest.approx(off[:2])
    # The third lies at 180 degrees: 1.6 rad is nearer to it than -1.5 rad round the other way.
    assert rows.innovation[2, 0] == pytest.approx(off[2], abs=1e-6)


def test_the_side_is_that_from_where_the_sensor_is() -> None:
    frame = replace(azimuth_frame(0.1, 3.1), position=np.array([2000.0, 0.0]))
    (innovation,) = rows_of(bank_at([1000.0, 0.0, 0.0, 0.0]), frame).innovation
    assert innovation[0] == pytest.approx(3.1 - np.pi)


def test_the_innovation_varies_by_prediction_and_measurement() -> None:
    bank = bank_at([1000.0, 0.0, 0.0, 0.0])
    rows = rows_of(bank, azimuth_frame(0.0))
    # 1 m across at 1000 m is 1 mrad.
    assert innovation_variance(bank, rows)[0, 0] == pytest.approx(1e-6 + 1e-4)


def test_an_ordinary_step_predicts_seeds_and_updates() -> None:
    frame = replace(
        azimuth_frame(np.pi / 2.0),
        frequency=np.array([300.0]),
        frequency_deviation=np.array([0.1]),
    )
    bank = replace(bank_at([0.0, 1000.0, 5.0, 0.0, 0.0]), known=np.zeros(1, bool))
    stepped = extended_step(bank, frame, interval=2.0, acceleration=0.0)
    assert stepped.known.tolist() == [True]
    # Predicted to x = 10 m with the variance 1 + 2^2; the azimuth then says x = 0 +- 10 m.
    assert stepped.mean[0, 0] == pytest.approx(10.0 * 100.0 / 105.0, rel=1e-3)
    assert stepped.covariance[0, 0, 0] == pytest.approx(5.0 * 100.0 / 105.0, rel=1e-3)


def test_an_estimate_names_the_frequencies_that_are_known() -> None:
    bank = bank_at([1.0, 2.0, 3.0, 4.0, 300.0, 200.0])
    bank = replace(bank, covariance=4.0 * bank.covariance, known=np.array([True, False]))
    estimate = estimate_of(bank, azimuth_frame(0.0))
    assert estimate.mean.tolist() == [1.0, 2.0, 3.0, 4.0]
    np.testing.assert_allclose(estimate.source_frequency, [300.0, np.nan])
    np.testing.assert_allclose(estimate.source_frequency_deviation, [2.0, np.nan])
    assert estimate.covariance.shape == (4, 4)
    assert not estimate.manoeuvre
    assert not estimate.restarted
    assert not np.any(estimate.reborn)


def test_an_estimate_has_the_moments_of_the_mixture() -> None:
    bank = bank_at([100.0, 2.0, 3.0, 4.0, 300.0, 200.0], [0.0, 9.0, -3.0, 5.0, 310.0, 190.0])
    leaning = np.eye(6) + 0.3 * np.ones((6, 6)) + np.diag(np.arange(6.0))
    covariance = np.stack([leaning, 2.0 * leaning])
    bank = replace(bank, covariance=covariance, log_weight=np.log([0.2, 0.8]))
    mean, covariance = mixture_moments(bank)
    estimate = estimate_of(bank, azimuth_frame(0.0))
    np.testing.assert_allclose(estimate.mean, mean[:4])
    np.testing.assert_allclose(estimate.covariance, covariance[:4, :4])
    np.testing.assert_allclose(estimate.source_frequency, mean[4:])
    np.testing.assert_allclose(estimate.source_frequency_deviation**2, np.diag(covariance)[4:])


def test_intervals_are_seconds() -> None:
    assert elapsed(1_000_000_000, 3_500_000_000) == 2.5


def test_the_elevation_of_something_else_is_left_out_with_its_azimuth() -> None:
    """Not the other way round: a reflection has the azimuth of what is reflected."""
    innovation = np.array([[[9.0, 1.0, 1.0], [1.0, 9.0, 1.0]]])
    everything = np.ones(innovation.shape, dtype=bool)
    rows = LinearisedRows(
        innovation, np.ones((*innovation.shape, 5)), np.ones(innovation.shape), everything
    )
    within, _ = gate_rows(rows, np.ones(innovation.shape), 4.0)
    assert within.present.tolist() == [[[False, False, True], [True, False, True]]]
