"""Bearing and range of near sources: the bound, and two estimators that come near it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import beamwidth, line_array
from sonar_tracking.passive.near_field import near_field_search
from sonar_tracking.passive.near_field.near_field_bound import (
    near_field_bound,
    near_field_information,
)
from sonar_tracking.passive.near_field.near_field_search import (
    NearFieldFix,
    NearFieldGrid,
    near_field_grid,
    near_field_maximum_likelihood,
    near_field_music,
)
from sonar_tracking.passive.near_field.spherical_steering import (
    rayleigh_distance,
    spherical_vectors,
)
from sonar_tracking.records.arrays import ComplexArray
from tests.passive.crossing_scene import circular_noise

WAVENUMBER = 2.0 * np.pi
POSITIONS = line_array(12, 0.45)
ANGLES, RANGES = np.deg2rad([-25.0, 20.0]), np.array([5.0, 7.0])
GRID = near_field_grid(POSITIONS, WAVENUMBER, 2.0)
Estimator = Callable[[ComplexArray, int, NearFieldGrid], NearFieldFix]
ESTIMATORS: tuple[Estimator, ...] = (near_field_maximum_likelihood, near_field_music)


def sample(
    generator: np.random.Generator, mixing: np.ndarray, n_snapshots: int, level: float = 10.0
) -> np.ndarray:
    """Return a sample covariance of signals from ANGLES and RANGES, amplitude sqrt(level)."""
    vectors = spherical_vectors(POSITIONS, ANGLES, 1.0 / RANGES, WAVENUMBER)
    signals = circular_noise(generator, mixing.shape[1], n_snapshots)
    data = np.sqrt(level) * vectors @ mixing @ signals
    data = data + circular_noise(generator, len(POSITIONS), n_snapshots)
    return np.asarray(data @ data.conj().T / n_snapshots)


def full_information(parameters: np.ndarray, n_snapshots: int) -> np.ndarray:
    """Return N tr(R^-1 dR R^-1 dR) over angles, ranges, source covariance and noise power."""

    def model(p: np.ndarray) -> np.ndarray:
        vectors = spherical_vectors(POSITIONS, p[:2], 1.0 / p[2:4], WAVENUMBER)
        sources = np.array([[p[4], p[6] + 1j * p[7]], [p[6] - 1j * p[7], p[5]]])
        noise = p[8] * np.eye(len(POSITIONS))
        return np.asarray(vectors @ sources @ vectors.conj().T + noise)

    inverse, step = np.linalg.inv(model(parameters)), 1e-5
    slopes = [
        inverse @ (model(parameters + step * e) - model(parameters - step * e)) / (2 * step)
        for e in np.eye(len(parameters))
    ]
    return n_snapshots * np.array([[np.trace(a @ b).real for b in slopes] for a in slopes])


def test_the_bound_is_that_of_the_whole_gaussian_model() -> None:
    parameters = np.array([*ANGLES, *RANGES, 3.0, 2.0, 0.5, 0.8, 1.0])
    full = np.sqrt(np.diagonal(np.linalg.inv(full_information(parameters, 50))))
    sources = np.array([[3.0, 0.5 + 0.8j], [0.5 - 0.8j, 2.0]])
    information = near_field_information(POSITIONS, ANGLES, RANGES, WAVENUMBER, sources, 1.0, 50)
    angle, distance = near_field_bound(information)
    assert np.allclose(angle, full[:2], rtol=1e-4)
    assert np.allclose(distance, full[2:4], rtol=1e-4)


def test_twice_the_range_is_four_times_as_uncertain() -> None:
    def bound(distance: float) -> float:
        one = np.ones((1, 1), np.complex128)
        information = near_field_information(
            POSITIONS, np.zeros(1), np.array([distance]), WAVENUMBER, one, 1.0, 100
        )
        return float(near_field_bound(information)[1][0])

    assert bound(200.0) / bound(100.0) == pytest.approx(4.0, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_errors_come_near_the_bound(estimator: Estimator) -> None:
    generator, n_snapshots, errors = np.random.default_rng(1), 100, []
    for _ in range(60):
        fix = estimator(sample(generator, np.eye(2), n_snapshots), 2, GRID)
        errors.append(np.concatenate([fix.angles - ANGLES, fix.ranges - RANGES]))
    sources = np.diag([10.0 + 0.0j, 10.0])
    bound = near_field_bound(
        near_field_information(POSITIONS, ANGLES, RANGES, WAVENUMBER, sources, 1.0, n_snapshots)
    )
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / np.concatenate(bound)
    assert (ratio < 1.35).all() and (ratio > 0.75).all()


def test_a_plane_wave_misses_a_near_source_and_a_spherical_one_does_not() -> None:
    covariance = sample(np.random.default_rng(2), np.eye(2), 400)
    plane = near_field_maximum_likelihood(
        covariance, 2, near_field_grid(POSITIONS, WAVENUMBER, None)
    )
    spherical = near_field_maximum_likelihood(covariance, 2, GRID)
    assert np.isinf(plane.ranges).all()
    assert np.abs(spherical.angles - ANGLES).max() < np.deg2rad(0.2)
    assert np.abs(plane.angles - ANGLES).max() > np.deg2rad(1.0)
    assert np.abs(spherical.ranges / RANGES - 1.0).max() < 0.1


def test_coherent_sources_are_found_by_maximum_likelihood() -> None:
    mixing = np.array([[1.0], [np.exp(1j)]])
    fix = near_field_maximum_likelihood(sample(np.random.default_rng(3), mixing, 200), 2, GRID)
    assert np.abs(fix.angles - ANGLES).max() < np.deg2rad(0.5)
    assert np.abs(fix.ranges / RANGES - 1.0).max() < 0.15


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_a_far_source_is_not_called_near(estimator: Estimator) -> None:
    vectors = spherical_vectors(POSITIONS, [0.3], [0.0], WAVENUMBER)
    covariance = 10.0 * vectors @ vectors.conj().T + np.eye(len(POSITIONS))
    fix = estimator(covariance, 1, GRID)
    assert fix.angles == pytest.approx([0.3], abs=1e-4)
    assert fix.ranges[0] > 50.0 * rayleigh_distance(POSITIONS, WAVENUMBER)


@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("n_sources", [0, 12])
def test_impossible_numbers_of_sources_are_refused(estimator: Estimator, n_sources: int) -> None:
    with pytest.raises(InputError, match="at least 1 and at most 11"):
        estimator(np.eye(12, dtype=complex), n_sources, GRID)


def circle(n_elements: int = 8) -> np.ndarray:
    around = 2.0 * np.pi * np.arange(n_elements) / n_elements
    return np.stack([np.cos(around), np.sin(around), np.zeros(n_elements)], axis=1)


def test_a_line_is_looked_at_evenly_in_sine_four_times_a_beam() -> None:
    width = beamwidth(POSITIONS, WAVENUMBER)
    sines = np.sin(GRID.angles)
    assert np.diff(sines) == pytest.approx(np.full(len(sines) - 1, sines[1] - sines[0]))
    assert sines[1] - sines[0] <= width / 4.0
    assert (sines[1] - sines[0]) * 4.0 / width > 0.75
    assert sines[0] == pytest.approx(-sines[-1])
    assert 1.0 - sines[-1] == pytest.approx(sines[1] - sines[0])
    # Rayleigh's distance is 49 m, 24.5 times the least range: 25 steps of curvature from 0 on.
    assert len(GRID.curvatures) == 26
    assert (GRID.curvatures[0], GRID.curvatures[-1]) == (0.0, 0.5)
    assert near_field_grid(POSITIONS, WAVENUMBER, None).curvatures.tolist() == [0.0]


def test_an_array_that_is_no_line_is_looked_at_all_round() -> None:
    grid = near_field_grid(circle(), WAVENUMBER, None)
    step = grid.angles[1] - grid.angles[0]
    assert np.diff(grid.angles) == pytest.approx(np.full(len(grid.angles) - 1, step))
    assert grid.angles[0] == -np.pi
    assert grid.angles[-1] == pytest.approx(np.pi - step)
    assert 0.75 < step * 4.0 / beamwidth(circle(), WAVENUMBER) <= 1.0


def test_steering_vectors_have_norm_one() -> None:
    vectors = GRID.vectors(np.array([[0.3, 0.2], [-1.0, 0.0]]))
    assert np.linalg.norm(vectors, axis=0) == pytest.approx([1.0, 1.0])
    plain = spherical_vectors(POSITIONS, [0.3], [0.2], WAVENUMBER)[:, 0]
    assert vectors[:, 0] == pytest.approx(plain / np.linalg.norm(plain))


def test_a_spectrum_is_the_least_cost_over_all_curvatures(monkeypatch: pytest.MonkeyPatch) -> None:
    covariance = sample(np.random.default_rng(4), np.eye(2), 50)

    def missed(vectors: ComplexArray) -> np.ndarray:
        return -(vectors.conj() * (covariance @ vectors)).real.sum(axis=0)

    costs, curvatures = GRID.spectrum(missed)
    for row in range(0, len(GRID.angles), 7):
        points = np.stack([np.full(26, GRID.angles[row]), GRID.curvatures], axis=1)
        own = missed(GRID.vectors(points))
        assert costs[row] == pytest.approx(np.min(own))
        assert curvatures[row] == GRID.curvatures[np.argmin(own)]
    monkeypatch.setattr(near_field_search, "_VECTORS_AT_ONCE", 10)
    again, _ = GRID.spectrum(missed)
    assert again == pytest.approx(costs)


@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize(
    ("angles_deg", "ranges"),
    [([-40.0], [3.0]), ([75.0], [9.0]), ([-25.0, 20.0], [5.0, 7.0]), ([5.0, 17.0], [4.0, 12.0])],
)
def test_without_errors_in_the_covariance_the_fix_is_exact(
    estimator: Estimator, angles_deg: list[float], ranges: list[float]
) -> None:
    angles = np.radians(angles_deg)
    vectors = spherical_vectors(POSITIONS, angles, 1.0 / np.array(ranges), WAVENUMBER)
    covariance = 5.0 * vectors @ vectors.conj().T + np.eye(len(POSITIONS))
    fix = estimator(covariance, len(angles), GRID)
    # Maximum likelihood of two sources takes the one for a little of the other at the end.
    assert fix.angles == pytest.approx(angles, abs=2e-5)
    assert fix.ranges == pytest.approx(ranges, rel=2e-3)


@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("angle_deg", [-170.0, -100.0, 0.0, 60.0, 179.0])
def test_a_circle_tells_ahead_from_astern(estimator: Estimator, angle_deg: float) -> None:
    positions = circle()
    grid = near_field_grid(positions, WAVENUMBER, 2.0)
    vectors = spherical_vectors(positions, [np.radians(angle_deg)], [1.0 / 4.0], WAVENUMBER)
    fix = estimator(5.0 * vectors @ vectors.conj().T + np.eye(8), 1, grid)
    off = np.exp(1j * fix.angles) / np.exp(1j * np.radians(angle_deg))
    assert np.angle(off) == pytest.approx([0.0], abs=1e-4)
    assert fix.ranges == pytest.approx([4.0], rel=1e-2)


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_a_source_nearer_than_is_looked_for_is_put_at_the_bound(estimator: Estimator) -> None:
    vectors = spherical_vectors(POSITIONS, [0.2], [1.0 / 1.2], WAVENUMBER)
    fix = estimator(5.0 * vectors @ vectors.conj().T + np.eye(len(POSITIONS)), 1, GRID)
    assert fix.ranges == pytest.approx([2.0])


@pytest.mark.parametrize("n_sources", [1, 2])
def test_music_reports_the_deepest_valleys_in_order_of_bearing(n_sources: int) -> None:
    """With one strong and one weak source, and only one asked for, it is the strong one."""
    angles, levels = np.radians([40.0, -30.0]), np.array([100.0, 2.0])
    vectors = spherical_vectors(POSITIONS, angles, np.full(2, 1.0 / 6.0), WAVENUMBER)
    covariance = vectors @ np.diag(levels) @ vectors.conj().T + np.eye(len(POSITIONS))
    fix = near_field_music(covariance, n_sources, GRID)
    expected = [-30.0, 40.0] if n_sources == 2 else [40.0]
    assert np.degrees(fix.angles) == pytest.approx(expected, abs=0.3)


class _PlainGrid(NearFieldGrid):
    """Steering vectors that are the points themselves, so that a cost can be told by them."""

    def vectors(self, points: np.ndarray) -> np.ndarray:
        return points.T


@pytest.mark.parametrize("n_curvatures", [2, 3, 5])
def test_the_search_begins_between_the_points_of_the_grid(n_curvatures: int) -> None:
    """Half a cell of three angles to either side, and the next curvature."""
    angles = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    curvatures = np.array([0.0, 0.2, 0.4, 0.6, 0.8])[:n_curvatures]
    grid = _PlainGrid(POSITIONS, WAVENUMBER, angles, curvatures)
    tried: list[np.ndarray] = []

    def cost(points: np.ndarray) -> np.ndarray:
        tried.append(points.T)
        return np.hypot(points[0] - 0.3, points[1])

    found = grid.refined(cost, np.array([0.3, 0.0]))
    assert found.tolist() == [0.3, 0.0]
    assert np.unique(np.round(tried[1], 9), axis=0).tolist() == [
        [angle, curvature] for angle in (0.2, 0.3, 0.4) for curvature in (0.0, 0.2)
    ]
