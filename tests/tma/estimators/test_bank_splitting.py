"""Protects the narrowing of range hypotheses: same mixture, narrow as seen from elsewhere."""

import numpy as np
import pytest

from sonar_tracking.tma.estimators.bank_splitting import (
    MOST_COMPONENTS,
    WIDE,
    split_bank,
    without_unlikely,
)
from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    mixture_moments,
    start_bank,
)
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.targets.station_association import azimuth_log_likelihood

ELSEWHERE = np.array([6000.0, 0.0])


def started() -> HypothesisBank:
    measurement = TmaMeasurement(
        stamp=0,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.array([0.9]),
        azimuth_variance=np.array(np.radians(0.5) ** 2),
    )
    bank = start_bank(measurement, RangeBankConfiguration().range_edges(), 20.0)
    # Ranges and velocities go together, as after some measurements.
    direction = np.array([np.cos(0.9), np.sin(0.9)])
    along = np.concatenate([direction, 1e-3 * direction])
    covariance = bank.covariance + 1e4 * np.outer(along, along)
    return HypothesisBank(bank.mean, covariance, bank.log_weight, bank.known)


def test_the_mixture_stays_what_it_was() -> None:
    before, after = started(), split_bank(started(), ELSEWHERE)
    assert len(after.log_weight) > len(before.log_weight)
    for one, other in zip(mixture_moments(before), mixture_moments(after), strict=True):
        assert other == pytest.approx(one, rel=1e-9, abs=1e-6)
    assert np.exp(after.log_weight).sum() == pytest.approx(1.0)
    assert np.all(np.linalg.eigvalsh(after.covariance) > 0.0)


def test_it_ends_at_a_bounded_number() -> None:
    near = np.array([600.0, 900.0])
    assert len(split_bank(started(), near).log_weight) <= MOST_COMPONENTS


def test_what_is_narrow_already_is_left_alone() -> None:
    bank = started()
    assert split_bank(bank, np.array([0.0, -1e6])) is bank
    assert WIDE < 0.5


def test_an_azimuth_from_elsewhere_has_a_likelihood_all_along_the_bearing() -> None:
    """Targets at any range along the first bearing are found likely from the other station."""
    bank = split_bank(started(), ELSEWHERE)
    ranges = np.linspace(800.0, 15_000.0, 60)
    offset = ranges[:, None] * np.array([np.cos(0.9), np.sin(0.9)]) - ELSEWHERE
    azimuths = np.arctan2(offset[:, 1], offset[:, 0])
    variance = np.full(len(ranges), np.radians(0.5) ** 2)
    likely = azimuth_log_likelihood(bank, 0.0, 0.01, ELSEWHERE, azimuths, variance)
    assert np.min(likely) > np.log(0.05)


def test_the_unlikely_are_forgotten_and_the_weights_sum_to_one() -> None:
    bank = started()
    weights = np.log(np.array([0.5, 0.5, 1e-12, 1e-12, 1e-12, 1e-12]))
    kept = without_unlikely(HypothesisBank(bank.mean, bank.covariance, weights, bank.known))
    assert len(kept.log_weight) == 2
    assert np.exp(kept.log_weight) == pytest.approx([0.5, 0.5])
    assert without_unlikely(bank) is bank
