"""Protects the pairing of bearings of several stations."""

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.targets.station_association import (
    FREE,
    associate,
    azimuth_log_likelihood,
    direction_log_likelihood,
)

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


def likelihoods(measured: FloatArray) -> FloatArray:
    rows = []
    for target in range(len(TARGETS)):
        state = bank_of(target).state
        assert state is not None
        rows.append(
            azimuth_log_likelihood(
                state.bank, 0.0, 0.01, THERE, measured, np.full(len(measured), VARIANCE)
            )
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
        return direction_log_likelihood(bank.state.bank, 0.0, 0.01, direction(elevation))

    bank.update(direction(float(np.arctan2(height, distance))))
    assert likelihood(float(np.arctan2(height, distance))) > likelihood(
        float(np.arctan2(height, 1.2 * distance))
    )
    assert likelihood(float(np.radians(80.0))) < likelihood(np.nan) - 10.0
    # Without elevation it is the likelihood of the azimuth alone, per rad.
    alone = direction(np.nan)
    assert bank.state is not None
    expected = azimuth_log_likelihood(
        bank.state.bank, 0.0, 0.01, HERE, alone.azimuth, np.array([VARIANCE])
    )
    assert likelihood(np.nan) == pytest.approx(float(expected[0]), abs=1e-6)
