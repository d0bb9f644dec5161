"""Protects what constant errors of directions add to a position, by answers derived by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.tma.targets.systematic_errors import (
    Sight,
    SystematicErrors,
    systematic_covariance,
)

DEVIATION = 0.01
ERRORS = SystematicErrors(DEVIATION)


def sight(x: float, y: float, height: float = 0.0, elevated: bool = False) -> Sight:
    return Sight((x, y), 0.0, height, elevated, 0)


def test_one_station_without_elevations_errs_across_its_line_of_sight() -> None:
    covariance = systematic_covariance(np.array([3000.0, 0.0]), [sight(0.0, 0.0)], ERRORS)
    assert covariance == pytest.approx(np.diag([0.0, 30.0**2]))


def test_an_elevation_gives_the_range_its_error_too() -> None:
    """With tan e = h / r: dr = (r^2 + h^2) / h de."""
    seen = sight(0.0, 0.0, height=500.0, elevated=True)
    covariance = systematic_covariance(np.array([1000.0, 0.0]), [seen], ERRORS)
    across = 10.0 * np.sqrt(1.25)  # a direction errs at the slant range, whatever its azimuth
    assert covariance == pytest.approx(np.diag([25.0**2, across**2]))
    unused = systematic_covariance(np.array([1000.0, 0.0]), [sight(0.0, 0.0, 500.0)], ERRORS)
    assert unused == pytest.approx(np.diag([0.0, 10.0**2]))


@pytest.mark.parametrize("distance", [900.0, 9000.0, 9200.0, 40000.0])
def test_a_range_that_a_flat_elevation_gives_errs_by_all_the_more(distance: float) -> None:
    """Of a ship 9 km away and 900 m above, 0.01 rad are 900 m: never is such a range exact."""
    seen = sight(0.0, 0.0, height=900.0, elevated=True)
    covariance = systematic_covariance(np.array([distance, 0.0]), [seen], ERRORS)
    along = (distance**2 + 900.0**2) / 900.0 * DEVIATION
    assert np.sqrt(covariance[0, 0]) == pytest.approx(along)


def test_a_station_that_moves_finds_the_range_without_flat_elevations() -> None:
    first = sight(0.0, 0.0, height=300.0, elevated=True)
    assert not first.after(None).moved and not first.after(first).moved
    moving = sight(5.0, 0.0, height=300.0, elevated=True).after(first)
    assert moving.moved and moving.after(moving).moved
    covariance = systematic_covariance(np.array([4000.0, 0.0]), [moving], ERRORS)
    assert np.sqrt(covariance[0, 0]) < 10.0


def test_two_stations_at_right_angles_fix_both_axes() -> None:
    stations = [sight(0.0, 0.0), sight(1000.0, -2000.0)]
    covariance = systematic_covariance(np.array([1000.0, 0.0]), stations, ERRORS)
    assert covariance == pytest.approx(np.diag([20.0**2, 10.0**2]))


def test_two_stations_in_one_direction_fix_nothing_along_it() -> None:
    stations = [sight(0.0, 0.0), sight(-1000.0, 10.0)]
    covariance = systematic_covariance(np.array([1000.0, 0.0]), stations, ERRORS)
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
    said = systematic_covariance(target, [sight(*place) for place in stations], ERRORS)
    assert np.cov(np.array(found).T) == pytest.approx(said, rel=0.15, abs=3.0)


def test_rays_are_bent_more_the_flatter_they_are() -> None:
    """Half of b / tan(e) where that is small, half of the root of b along the horizontal."""
    bent = SystematicErrors(0.0, bending=0.01)
    assert bent.of_elevation(1.0) == pytest.approx(0.005, rel=0.01)
    assert bent.of_elevation(0.0) == pytest.approx(0.05)
    both = SystematicErrors(0.003, bending=0.01)
    assert both.of_elevation(1.0) == pytest.approx(np.hypot(0.003, bent.of_elevation(1.0)))


def test_an_estimated_height_errs_with_the_range_that_two_stations_find() -> None:
    """Two stations at right angles, d = 1000 m away on the plane and d below.

    With J^T J = [[3, 0, -1], [0, 3, -1], [-1, -1, 2]] / 4 d^2 the variances are 4 d^2 s^2 times
    5/12, 5/12 and 9/12.
    """
    stations = [Sight(place, -1000.0, 0.0, True, 0) for place in ((0.0, 0.0), (1000.0, -1000.0))]
    target = np.array([1000.0, 0.0, 0.0])
    said = systematic_covariance(target, stations, ERRORS)
    assert np.diag(said) == pytest.approx(400.0 * np.array([5.0, 5.0, 9.0]) / 12.0)


def test_the_size_of_a_target_is_added() -> None:
    errors = SystematicErrors(DEVIATION, size=7.0)
    seen = [sight(0.0, 0.0)]
    more = systematic_covariance(np.array([3000.0, 0.0]), seen, errors)
    less = systematic_covariance(np.array([3000.0, 0.0]), seen, ERRORS)
    assert more - less == pytest.approx(49.0 * np.eye(2))
