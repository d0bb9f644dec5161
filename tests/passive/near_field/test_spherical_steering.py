"""Curved wavefronts: exact distances, the plane wave as their limit, and where it stops to hold."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import Severity
from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.near_field.spherical_steering import (
    plane_wave_notice,
    rayleigh_distance,
    spherical_derivatives,
    spherical_vectors,
)

WAVENUMBER = 2.0 * np.pi * 5000.0 / 343.0
LINE = line_array(32, 0.03)
BENT = np.array([[0.0, 0.0, 0.0], [0.1, 0.03, 0.0], [0.2, -0.02, 0.05], [0.3, 0.01, 0.0]])
ANGLES = np.deg2rad([-70.0, -10.0, 0.0, 35.0])


@pytest.mark.parametrize("positions", [LINE, BENT])
def test_delays_and_levels_are_those_of_the_distances(positions: np.ndarray) -> None:
    ranges = np.array([0.4, 0.6, 2.0, 30.0])
    vectors = spherical_vectors(positions, ANGLES, 1.0 / ranges, WAVENUMBER)
    centre = positions.mean(axis=0)
    toward = np.stack([np.sin(ANGLES), np.cos(ANGLES), np.zeros(4)], axis=-1)
    sources = centre + ranges[:, None] * toward
    distances = np.linalg.norm(positions[:, None] - sources, axis=-1)
    expected = ranges / distances * np.exp(-1j * WAVENUMBER * (distances - ranges))
    assert np.allclose(vectors, expected, atol=1e-10)


def test_without_curvature_the_wave_is_plane() -> None:
    plane = steering_vectors(LINE, ANGLES, WAVENUMBER, "array_centre")
    assert np.allclose(spherical_vectors(LINE, ANGLES, np.zeros(4), WAVENUMBER), plane, atol=1e-12)
    far = spherical_vectors(LINE, ANGLES, np.full(4, 1e-7), WAVENUMBER)
    assert np.abs(far - plane).max() < 1e-5


@pytest.mark.parametrize("positions", [LINE, BENT])
@pytest.mark.parametrize("curvature", [0.0, 0.04, 2.0])
def test_derivatives_are_those_of_differences(positions: np.ndarray, curvature: float) -> None:
    curvatures, step = np.full(4, curvature), 1e-6
    derivatives = spherical_derivatives(positions, ANGLES, curvatures, WAVENUMBER)
    vectors, by_angle, by_curvature = derivatives

    def at(angle_step: float, curvature_step: float) -> np.ndarray:
        changed = curvatures + curvature_step
        return spherical_vectors(positions, ANGLES + angle_step, changed, WAVENUMBER)

    assert np.allclose(vectors, at(0.0, 0.0))
    assert np.allclose(by_angle, (at(step, 0.0) - at(-step, 0.0)) / (2 * step), atol=1e-5)
    assert np.allclose(by_curvature, (at(0.0, step) - at(0.0, -step)) / (2 * step), atol=1e-5)


def test_the_limit_of_plane_waves_by_hand() -> None:
    limit = rayleigh_distance(LINE, WAVENUMBER)
    assert limit == pytest.approx(2.0 * 0.93**2 / (343.0 / 5000.0))
    curved = spherical_vectors(LINE, [0.0], [1.0 / limit], WAVENUMBER)[:, 0]
    assert abs(np.angle(curved[0])) == pytest.approx(np.pi / 8.0, rel=1e-3)


def test_a_source_nearer_than_the_limit_is_told() -> None:
    notice = plane_wave_notice(0.5, LINE, WAVENUMBER, "source 1")
    assert notice is not None and notice.severity == Severity.WARN
    assert "source 1 is 0.5 m away, nearer than" in notice.text and "25.2 m" in notice.text
    assert plane_wave_notice(25.3, LINE, WAVENUMBER, "source 1") is None
    assert plane_wave_notice(np.inf, LINE, WAVENUMBER, "source 1") is None
    assert plane_wave_notice(1.3, LINE[:8], WAVENUMBER, "source 1") is None
