"""Powers on the grid of arrival angles are those of its steering vectors, however computed."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import beamwidth, line_array, steering_vectors
from sonar_tracking.passive.sources import angle_grid as module
from sonar_tracking.passive.sources.angle_grid import SteeredGrid, UniformLineGrid, angle_grid
from sonar_tracking.records.arrays import FloatArray
from tests.passive.crossing_scene import circular_noise

WAVENUMBER = 2.0 * np.pi


def circle(n_elements: int) -> FloatArray:
    around = np.linspace(0.0, 2.0 * np.pi, n_elements, endpoint=False)
    return np.stack([0.6 * np.sin(around), 0.6 * np.cos(around), 0.0 * around], axis=1)


def uneven_line(n_elements: int) -> FloatArray:
    positions = line_array(n_elements, 0.5)
    positions[:, 0] += 0.1 * np.sin(np.arange(n_elements))
    return positions


@pytest.mark.parametrize(
    "positions",
    [
        *(line_array(15, spacing) for spacing in (0.5, 0.13, 0.49, 0.8, 1.7)),
        *(line_array(2, spacing) for spacing in (0.02, 0.5)),
        circle(9),
        uneven_line(12),
    ],
)
@pytest.mark.parametrize("rounded", [False, True])
def test_power_is_that_of_the_steering_vectors(positions: FloatArray, rounded: bool) -> None:
    vectors = circular_noise(np.random.default_rng(1), len(positions), 3)
    grid = angle_grid(positions, WAVENUMBER, rounded)
    steered = steering_vectors(positions, grid.angles, WAVENUMBER)
    expected = (np.abs(vectors.conj().T @ steered) ** 2).sum(axis=0)
    assert np.allclose(grid.power(vectors), expected, rtol=1e-9, atol=1e-9)
    assert np.all(np.diff(grid.angles) > 0.0)


@pytest.mark.parametrize("spacing", [0.13, 0.5, 0.8])
@pytest.mark.parametrize("rounded", [False, True])
def test_a_line_is_looked_at_from_end_to_end_sixteen_times_a_beam(
    spacing: float, rounded: bool
) -> None:
    positions = line_array(20, spacing)
    sines = np.sin(angle_grid(positions, WAVENUMBER, rounded).angles)
    most = beamwidth(positions, WAVENUMBER) / 16.0
    assert np.diff(sines).max() < most
    assert sines[0] + 1.0 < most and 1.0 - sines[-1] < most


@pytest.mark.parametrize("wavenumber", [WAVENUMBER, 1.37 * WAVENUMBER])
@pytest.mark.parametrize("n_elements", [5, 8, 9])
def test_a_circle_is_looked_at_all_round_sixteen_times_a_beam(
    n_elements: int, wavenumber: float
) -> None:
    positions = circle(n_elements)
    angles = angle_grid(positions, wavenumber).angles
    step = np.diff(angles).max()
    assert step <= beamwidth(positions, wavenumber) / 16.0
    assert angles[-1] - angles[0] + step == pytest.approx(2.0 * np.pi)


@pytest.mark.parametrize("n_elements", [12, 32, 64])
def test_a_rounded_grid_has_few_angles_more_and_no_large_factor(n_elements: int) -> None:
    positions = line_array(n_elements, 0.5)
    plain, rounded = (angle_grid(positions, WAVENUMBER, each) for each in (False, True))
    assert isinstance(plain, UniformLineGrid) and isinstance(rounded, UniformLineGrid)
    assert plain.length <= rounded.length < 1.1 * plain.length
    assert 2**30 * 3**30 * 5**30 % rounded.length == 0
    assert angle_grid(circle(8), WAVENUMBER, rounded=True) is angle_grid(circle(8), WAVENUMBER)


def test_uniform_lines_need_no_steering_vectors() -> None:
    assert isinstance(angle_grid(line_array(512, 0.5), WAVENUMBER), UniformLineGrid)
    assert isinstance(angle_grid(circle(8), WAVENUMBER), SteeredGrid)


def test_too_many_steering_vectors_are_not_kept_but_computed_in_portions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    positions = circle(9)
    vectors = circular_noise(np.random.default_rng(2), 9, 2)
    kept = angle_grid(positions, WAVENUMBER)
    monkeypatch.setattr(module, "_LARGEST_KEPT", 0)
    monkeypatch.setattr(module, "_ANGLES_AT_ONCE", 7)
    other = angle_grid(positions, WAVENUMBER * (1.0 + 1e-12))
    assert isinstance(other, SteeredGrid) and other.steering is None
    assert np.allclose(other.power(vectors), kept.power(vectors), rtol=1e-9)
