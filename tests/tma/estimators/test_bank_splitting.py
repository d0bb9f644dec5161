"""Protects the narrowing of range hypotheses: same mixture, narrow as seen from elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.bank_splitting import (
    MOST_HYPOTHESES,
    WIDE,
    split_bank,
    without_unlikely,
)
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, start_bank
from sonar_tracking.tma.estimators.mixture_moments import mixture_moments
from sonar_tracking.tma.estimators.motion_modes import MODES, weaving_modes, with_modes
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.stations.station_association import weigh_azimuths

ELSEWHERE = np.array([6000.0, 0.0])

PAIRS = RangeBankConfiguration(
    manoeuvre_interval=5.0,
    manoeuvre_duration=1.0,
    weave_speed=0.0,
    weave_probability=0.0,
    wander_probability=0.0,
)
"""Targets neither weave nor wander."""


def started() -> HypothesisBank:
    measurement = TmaMeasurement(
        stamp=0,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.array([0.9]),
        azimuth_variance=np.array(np.radians(0.5) ** 2),
    )
    bank = start_bank(measurement, RangeBankConfiguration().range_edges(), 20.0)
    bank = with_modes(bank, RangeBankConfiguration(weave_probability=0.5))
    # Ranges and velocities go together, as after some measurements.
    direction = np.array([np.cos(0.9), np.sin(0.9)])
    along = np.concatenate([direction, 1e-3 * direction])
    covariance = bank.covariance.copy()
    covariance[:, :4, :4] += 1e4 * np.outer(along, along)
    return HypothesisBank(bank.mean, covariance, bank.log_weight, bank.known)


def test_the_mixture_stays_what_it_was() -> None:
    before, after = started(), split_bank(started(), ELSEWHERE)
    assert len(after.log_weight) > len(before.log_weight)
    for one, other in zip(mixture_moments(before), mixture_moments(after), strict=True):
        assert other == pytest.approx(one, rel=1e-9, abs=1e-6)
    assert np.exp(after.log_weight).sum() == pytest.approx(1.0)
    assert np.all(np.linalg.eigvalsh(after.covariance[:, :4, :4]) > 0.0)
    weaving = after.covariance[weaving_modes(len(after.log_weight))]
    assert np.all(np.linalg.eigvalsh(weaving) > 0.0)


def test_it_ends_at_a_bounded_number() -> None:
    near = np.array([600.0, 900.0])
    assert len(split_bank(started(), near).log_weight) <= MOST_HYPOTHESES * MODES


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
    found = weigh_azimuths(
        [bank], np.zeros(1), np.array([0.01]), ELSEWHERE[None], azimuths[None], variance[None]
    )
    (likely,) = found.log_likelihood
    assert np.min(likely) > np.log(0.05)


def test_the_unlikely_are_forgotten_and_the_weights_sum_to_one() -> None:
    bank = started()
    unlikely = [1e-12] * (MODES - 1)
    likely = [0.5, 0.2, 0.1, *[1e-12] * (MODES - 3), *unlikely, 0.2]
    weights = np.log(np.array([*likely, *[1e-12] * (len(bank.log_weight) - len(likely))]))
    kept = without_unlikely(HypothesisBank(bank.mean, bank.covariance, weights, bank.known))
    assert len(kept.log_weight) == 2 * MODES, "all modes of a hypothesis stay"
    assert np.exp(kept.log_weight) == pytest.approx(likely)
    assert without_unlikely(bank) is bank


def wide_bank(along: float, count: int = 1) -> HypothesisBank:
    """Return hypotheses 1000 m north of the origin, known to 1 m but along east.

    The manoeuvring mode of each, a fifth as likely, is 5 m/s faster.
    """
    covariance = np.diag([along**2, 1.0, 1.0, 1.0])
    covariance[0, 2] = covariance[2, 0] = 0.5 * along
    bank = HypothesisBank(
        np.tile([0.0, 1000.0, 2.0, 0.0], (count, 1)),
        np.tile(covariance, (count, 1, 1)),
        np.full(count, -np.log(count)),
        np.zeros(0, dtype=bool),
    )
    both = with_modes(bank, PAIRS)
    both.mean[1::MODES, 2] += 5.0
    return both


@pytest.mark.parametrize(("along", "parts"), [(99.0, 1), (101.0, 3), (299.0, 3), (301.0, 9)])
def test_components_are_cut_in_three_until_they_are_a_tenth_of_a_radian_wide(
    along: float, parts: int
) -> None:
    """Seen from the origin, at 1000 m; each third of an even spread has a third of its width."""
    bank = split_bank(wide_bank(along), np.zeros(2))
    assert len(bank.log_weight) == parts * MODES
    deviation = np.sqrt(np.linalg.eigvalsh(bank.covariance[:, :2, :2])[:, -1])
    assert deviation == pytest.approx(np.full(parts * MODES, along / parts))


def test_thirds_lie_side_by_side_and_move_as_the_whole_says() -> None:
    """sqrt(12) deviations wide: a third of it is 115.5 m; the speed follows the place."""
    bank = split_bank(wide_bank(100.1), np.zeros(2))
    third = np.sqrt(12.0) * 100.1 / 3.0
    slope = 0.5 / 100.1
    for mode, (faster, weight) in enumerate([(0.0, 5.0 / 6.0), (5.0, 1.0 / 6.0)]):
        mean = bank.mean[mode::MODES]
        mean = mean[np.argsort(mean[:, 0])]
        assert mean[:, 0] == pytest.approx([-third, 0.0, third])
        middle = 2.0 + faster
        assert mean[:, 2] == pytest.approx([middle - slope * third, middle, middle + slope * third])
        assert mean[:, 1] == pytest.approx([1000.0] * 3)
        assert np.exp(bank.log_weight[mode::MODES]) == pytest.approx([weight / 3.0] * 3)
    assert bank.mean[::MODES, 0] == pytest.approx(bank.mean[1::MODES, 0]), "modes are neighbours"


@pytest.mark.parametrize(("count", "cut"), [(36, True), (37, False)])
def test_no_more_than_a_hundred_and_eight_hypotheses_are_made(count: int, cut: bool) -> None:
    bank = split_bank(wide_bank(1000.0, count), np.zeros(2))
    assert len(bank.log_weight) == MODES * (3 * count if cut else count)


@pytest.mark.parametrize(("share", "cut"), [(1.1e-3, True), (0.9e-3, False)])
def test_an_unlikely_component_need_not_be_narrow(share: float, cut: bool) -> None:
    both = wide_bank(50.0)
    covariance = both.covariance.copy()
    covariance[1, 0, 0] = 200.0**2
    weight = np.log([1.0 / (1.0 + share), share / (1.0 + share), *[1e-20] * (MODES - 2)])
    bank = split_bank(HypothesisBank(both.mean, covariance, weight, both.known), np.zeros(2))
    assert (len(bank.log_weight) > MODES) == cut


@pytest.mark.parametrize(("share", "kept"), [(2e-6, 3), (0.5e-6, 2)])
def test_a_millionth_of_the_best_does_not_matter(share: float, kept: int) -> None:
    bank = wide_bank(50.0, 3)
    unlikely = [1e-20] * (MODES - 1)
    weight = np.log([0.5, *unlikely, 0.5, *unlikely, *unlikely, 0.5 * share])
    assert len(without_unlikely(replace(bank, log_weight=weight)).log_weight) == kept * MODES


def test_the_width_is_that_seen_from_the_other_station() -> None:
    """Along the line of sight a component may be as long as it likes."""
    assert len(split_bank(wide_bank(150.0), np.array([0.0, -500.0])).log_weight) == MODES
    assert len(split_bank(wide_bank(150.0), np.array([5000.0, 1000.0])).log_weight) == MODES
    assert len(split_bank(wide_bank(90.0), np.array([0.0, 200.0])).log_weight) == 3 * MODES
