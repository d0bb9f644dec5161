"""Protects what constant errors of directions add to a position, by answers derived by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.tma.targets.systematic_errors import Sight, systematic_covariance

DEVIATION = 0.01


def sight(x: float, y: float, height: float = 0.0, elevated: bool = False) -> Sight:
    return Sight((x, y), height, elevated, 0)


def test_one_station_without_elevations_errs_across_its_line_of_sight() -> None:
    covariance = systematic_covariance(np.array([3000.0, 0.0]), [sight(0.0, 0.0)], DEVIATION)
    assert covariance == pytest.approx(np.diag([0.0, 30.0**2]))


def test_an_elevation_gives_the_range_its_error_too() -> None:
    """With tan e = h / r: dr = (r^2 + h^2) / h de."""
    seen = sight(0.0, 0.0, height=500.0, elevated=True)
    covariance = systematic_covariance(np.array([1000.0, 0.0]), [seen], DEVIATION)
    assert covariance == pytest.approx(np.diag([25.0**2, 10.0**2]))
    unused = systematic_covariance(np.array([1000.0, 0.0]), [sight(0.0, 0.0, 500.0)], DEVIATION)
    assert unused == pytest.approx(np.diag([0.0, 10.0**2]))


def test_two_stations_at_right_angles_fix_both_axes() -> None:
    stations = [sight(0.0, 0.0), sight(1000.0, -2000.0)]
    covariance = systematic_covariance(np.array([1000.0, 0.0]), stations, DEVIATION)
    assert covariance == pytest.approx(np.diag([20.0**2, 10.0**2]))


def test_two_stations_in_one_direction_fix_nothing_along_it() -> None:
    stations = [sight(0.0, 0.0), sight(-1000.0, 10.0)]
    covariance = systematic_covariance(np.array([1000.0, 0.0]), stations, DEVIATION)
    assert np.sqrt(covariance[0, 0]) < 1.0
    assert 8.0 < np.sqrt(covariance[1, 1]) < 10.0


def test_errors_of_simulated_crossings_are_as_large_as_said() -> None:
    target, stations = np.array([800.0, 900.0]), [(0.0, 0.0), (1500.0, 100.0)]
    generator, found = np.random.default_rng(3), []
    for _ in range(2000):
        rows, values = [], []
        for place in stations:
            offset = target - place
            azimuth = np.arctan2(offset[1], offset[0]) + DEVIATION * generator.standard_normal()
            normal = np.array([-np.sin(azimuth), np.cos(azimuth)])
            rows.append(normal)
            values.append(normal @ place)
        found.append(np.linalg.solve(rows, values))
    said = systematic_covariance(target, [sight(*place) for place in stations], DEVIATION)
    assert np.cov(np.array(found).T) == pytest.approx(said, rel=0.15, abs=3.0)
