"""Protects the pairing of bearings of several stations."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, predict_bank
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.stations.station_association import (
    CHANCE_DENSITY,
    CHANCE_DENSITY_WITH_ELEVATION,
    FREE,
    associate,
    direction_log_likelihoods,
    weigh_azimuths,
)
from tests.tma.estimators.test_hypothesis_bank import random_bank

HERE, THERE = np.array([0.0, 0.0]), np.array([4000.0, 0.0])
TARGETS = np.array([[1500.0, 3000.0], [3500.0, 4000.0]])
VARIANCE = np.radians(0.5) ** 2


def azimuths(place: FloatArray) -> FloatArray:
    offset = TARGETS - place
    return np.asarray(np.arctan2(offset[:, 1], offset[:, 0]))


def bank_of(target: int) -> RangeBank:
    bank = RangeBank()
    for second in range(5):
        bank.update(
            TmaMeasurement(
                stamp=second * 10**9,
                position=HERE,
                velocity=np.zeros(2),
                azimuth=azimuths(HERE)[target : target + 1],
                azimuth_variance=np.array(VARIANCE),
            )
        )
    return bank


def likelihood_of(
    bank: HypothesisBank,
    interval: float,
    acceleration: float,
    place: FloatArray,
    measured: FloatArray,
    variances: FloatArray,
) -> FloatArray:
    found = weigh_azimuths(
        [bank],
        np.array([interval]),
        np.array([acceleration]),
        place[None],
        measured[None],
        variances[None],
    )
    return np.asarray(found.log_likelihood[0])


def likelihoods(measured: FloatArray) -> FloatArray:
    rows = []
    for target in range(len(TARGETS)):
        state = bank_of(target).state
        assert state is not None
        rows.append(
            likelihood_of(state.bank, 0.0, 0.01, THERE, measured, np.full(len(measured), VARIANCE))
        )
    return np.array(rows)


def test_a_known_target_takes_its_bearing() -> None:
    sharp = np.log(np.array([[10.0, 1e-9], [1e-9, 10.0]]))
    assert associate(sharp).tolist() == [0, 1]
    assert associate(sharp[:, ::-1]).tolist() == [1, 0]


def test_a_bearing_without_a_target_stays_unassociated() -> None:
    one = np.array([[1.0, -np.inf, 0.5]])
    assert associate(one).tolist() == [0, FREE, FREE]
    assert associate(np.empty((0, 2))).tolist() == [FREE, FREE]


def test_an_azimuth_behind_the_station_is_impossible() -> None:
    behind = azimuths(THERE) + np.pi
    assert np.all(likelihoods(behind)[0] < np.log(1e-3))
    assert associate(likelihoods(np.array([-1.5]))).tolist() == [FREE]


def test_the_likelihood_is_a_density_over_all_azimuths() -> None:
    grid = np.linspace(-np.pi, np.pi, 20_001)[:-1]
    density = np.exp(likelihoods(grid))
    assert np.sum(density, axis=1) * (grid[1] - grid[0]) == pytest.approx([1.0, 1.0], abs=0.02)


def fit_of(
    measurement: TmaMeasurement, bank: HypothesisBank, acceleration: float, gate: float = 4.0
) -> float:
    """Return the log likelihood of one direction, if it is of one target."""
    found = direction_log_likelihoods([bank], np.zeros(1), acceleration, [measurement], gate)
    assert found.shape == (1, 1)
    return float(found[0, 0])


def test_an_elevation_tells_which_of_two_targets_on_one_azimuth_it_is() -> None:
    bank = bank_of(0)
    height = 1000.0
    distance = float(np.hypot(*TARGETS[0]))

    def direction(elevation: float) -> TmaMeasurement:
        return TmaMeasurement(
            stamp=10**10,
            position=HERE,
            velocity=np.zeros(2),
            azimuth=azimuths(HERE)[:1],
            azimuth_variance=np.array(VARIANCE),
            elevation=np.array(elevation),
            elevation_variance=np.array(VARIANCE),
            height=height,
        )

    def likelihood(elevation: float) -> float:
        assert bank.state is not None
        return fit_of(direction(elevation), bank.state.bank, 0.01)

    bank.update(direction(float(np.arctan2(height, distance))))
    assert likelihood(float(np.arctan2(height, distance))) > likelihood(
        float(np.arctan2(height, 1.2 * distance))
    )
    assert likelihood(float(np.radians(80.0))) < likelihood(np.nan) - 10.0
    # Without elevation it is the likelihood of the azimuth alone, per rad.
    alone = direction(np.nan)
    assert bank.state is not None
    expected = likelihood_of(bank.state.bank, 0.0, 0.01, HERE, alone.azimuth, np.array([VARIANCE]))
    assert likelihood(np.nan) == pytest.approx(float(expected[0]), abs=1e-6)


def test_the_likelihood_is_the_mixture_of_the_components_that_admit_the_azimuth() -> None:
    """Each component by its predicted place, its spread across the line of sight, its gate."""
    bank = random_bank(0, batch=())
    bank = replace(
        bank,
        mean=np.array([[0.0, 1000.0, 5.0, 0.0], [300.0, 1200.0, 0.0, -5.0], [9e3, 0.0, 0.0, 0.0]]),
        covariance=100.0 * bank.covariance,
    )
    place, azimuths_, variances = (
        np.array([50.0, 20.0]),
        np.array([1.5, 1.3]),
        np.array([1e-3, 4e-3]),
    )
    found = likelihood_of(bank, 3.0, 0.2, place, azimuths_, variances)
    moved = predict_bank(bank, 3.0, np.array(0.2))
    for column in range(2):
        total = 0.0
        for component in range(3):
            offset = moved.mean[component, :2] - place
            slope = np.array([-offset[1], offset[0]]) / (offset @ offset)
            spread = slope @ moved.covariance[component, :2, :2] @ slope + variances[column]
            off = np.angle(np.exp(1j * azimuths_[column]) / complex(*offset))
            if off**2 <= 16.0 * spread:
                density = np.exp(-0.5 * off**2 / spread) / np.sqrt(2.0 * np.pi * spread)
                total += np.exp(bank.log_weight[component]) * density
        assert np.exp(found[column]) == pytest.approx(total)
        assert total > 0.0


@pytest.mark.parametrize(("gate", "inside"), [(2.01, True), (1.99, False)])
def test_the_gate_is_that_of_azimuth_and_elevation_together(gate: float, inside: bool) -> None:
    """Two deviations off: 1.6 in azimuth and 1.2 in elevation."""
    bank = HypothesisBank(
        np.array([[1000.0, 0.0, 0.0, 0.0]]),
        1e-6 * np.eye(4)[None],
        np.zeros(1),
        np.zeros(0, dtype=bool),
    )
    frame = TmaMeasurement(
        stamp=1,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.array([1.6e-2]),
        azimuth_variance=np.array(1e-4),
        elevation=np.array(np.arctan2(500.0, 1000.0) - 2.4e-2),
        elevation_variance=np.array(4e-4),
        height=500.0,
    )
    found = fit_of(frame, bank, 0.0, gate)
    expected = -2.0 - np.log(2.0 * np.pi * 1e-2 * 2e-2)
    assert found == pytest.approx(expected if inside else -np.inf, rel=1e-6)
    alone = replace(frame, azimuth=np.array([0.0]), elevation=np.array(np.nan))
    found = fit_of(alone, bank, 0.0, gate)
    assert found == pytest.approx(-0.5 * np.log(2.0 * np.pi * 1e-4), rel=1e-6)


def test_a_bearing_from_anywhere_has_one_in_a_turn_and_with_elevation_in_half_a_sphere_s() -> None:
    assert pytest.approx(1.0 / (2.0 * np.pi)) == CHANCE_DENSITY
    assert pytest.approx(1.0 / np.pi**2) == CHANCE_DENSITY_WITH_ELEVATION
    for factor, taken in [(1.01, 0), (0.99, FREE)]:
        likely = np.log(np.array([[factor * CHANCE_DENSITY]]))
        assert associate(likely).tolist() == [taken]
        assert associate(likely + 1.0, math.e * CHANCE_DENSITY).tolist() == [taken]


def test_the_sum_of_the_gains_decides() -> None:
    """Both targets like the first bearing best; the first can do without it."""
    gains = np.log(np.array([[8.0, 6.0], [7.0, 0.1]]))
    assert associate(gains).tolist() == [1, 0]
