"""MUSIC: exactness on the exact covariance, resolution, accuracy, coloured noise."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sonar_tracking.geometry import line_array, steering_pair, steering_vectors
from sonar_tracking.passive.sources.angle_grid import angle_grid
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.passive.sources.music import (
    bearings_in_snapshots,
    music_bearings,
)
from sonar_tracking.passive.sources.null_spectrum import NullSpectrum
from sonar_tracking.records.arrays import ComplexArray
from tests.passive.block_scene import noise_from_ahead
from tests.passive.crossing_scene import (
    POSITIONS,
    WAVENUMBER,
    circular_noise,
    crossing_angles,
    snapshots_of,
)


@given(
    st.lists(st.integers(-17, 17), min_size=1, max_size=5, unique=True),
    st.floats(-0.4, 0.4),
)
@settings(max_examples=30, deadline=None)
def test_exact_covariance_gives_exact_angles(slots: list[int], shift: float) -> None:
    # Sources a whole slot of 4 deg apart (3 deg at least), anywhere between -70 and 70 deg.
    angles = np.sort(np.deg2rad(4.0 * np.array(slots) + shift))
    vectors = steering_vectors(POSITIONS, angles, WAVENUMBER)
    covariance = vectors @ vectors.conj().T + np.eye(15)
    found = music_bearings(covariance, len(angles), POSITIONS, WAVENUMBER)
    assert len(found) == len(angles)
    assert np.abs(found - angles).max() < 1e-7


def test_coloured_noise_does_not_pull_the_angles() -> None:
    angles = np.deg2rad([-10.0, 2.0])
    index = np.arange(15)
    colour = (0.8 ** np.abs(index[:, None] - index)).astype(complex)
    vectors = steering_vectors(POSITIONS, angles, WAVENUMBER)
    covariance = vectors @ vectors.conj().T + colour
    found = music_bearings(covariance, 2, POSITIONS, WAVENUMBER, colour)
    assert np.abs(found - angles).max() < 1e-7
    ignored = music_bearings(covariance, 2, POSITIONS, WAVENUMBER)
    assert np.abs(np.rad2deg(ignored - angles)).max() > 0.01


def test_array_of_any_shape_sees_all_around() -> None:
    generator = np.random.default_rng(1)
    around = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    positions = np.stack([0.5 * np.sin(around), 0.5 * np.cos(around), 0.0 * around], axis=1)
    angles = np.deg2rad([-150.0, 20.0])
    static = np.broadcast_to(angles, (400, 2))
    data = snapshots_of(generator, static, 20.0, positions=positions)
    found = music_bearings(sample_covariance(data), 2, positions, WAVENUMBER)
    assert np.rad2deg(found) == pytest.approx([-150.0, 20.0], abs=0.5)


@pytest.mark.parametrize(("level_db", "rms"), [(-5.0, 0.198), (0.0, 0.121)])
def test_start_accuracy_on_the_crossing_scene(level_db: float, rms: float) -> None:
    # First second of the scene, 200 snapshots; figures of an independent implementation.
    generator = np.random.default_rng(2)
    angles = np.broadcast_to(crossing_angles(0.5), (200, 5))
    errors = []
    for _ in range(40):
        data = snapshots_of(generator, angles, level_db)
        found = music_bearings(sample_covariance(data), 5, POSITIONS, WAVENUMBER)
        assert len(found) == 5
        errors.append(np.rad2deg(found - np.sort(angles[0])))
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(rms, rel=0.25)


def test_unresolved_sources_are_not_invented() -> None:
    angles = np.deg2rad([10.0, 10.3])
    static = np.broadcast_to(angles, (100, 2))
    data = snapshots_of(np.random.default_rng(3), static, -5.0)
    found = music_bearings(sample_covariance(data), 2, POSITIONS, WAVENUMBER)
    near = np.abs(np.rad2deg(found) - 10.15) < 2.0
    assert near.any()
    assert len(found) <= 2


def test_more_dimensions_than_sources_give_no_false_bearings() -> None:
    """A shallow valley of the null spectrum is not a source."""
    generator = np.random.default_rng(8)
    angles = np.deg2rad([-30.0, 20.0])
    vectors = steering_vectors(POSITIONS, angles, WAVENUMBER)
    for _ in range(20):
        drawn = generator.normal(size=(2, 17, 200)) / np.sqrt(2)
        noise = drawn[0] + 1j * drawn[1]
        data = (vectors @ (3.0 * noise[:2]) + noise[2:]).T
        found = music_bearings(sample_covariance(data), 4, POSITIONS, WAVENUMBER)
        assert np.allclose(found, angles, atol=np.deg2rad(0.5)) and len(found) == 2


@pytest.mark.parametrize(("outside", "kept"), [(0.25, True), (0.35, False)])
def test_a_valley_that_leaves_a_third_of_its_steering_vector_outside_is_no_source(
    outside: float, kept: bool
) -> None:
    """The signal subspace holds one vector, a part of which is at right angles to the array's."""
    vector, slope = (
        each[:, 0] for each in steering_pair(POSITIONS, np.array([0.2]), WAVENUMBER, "array_centre")
    )
    vector = vector / np.linalg.norm(vector)
    generator = np.random.default_rng(4)
    across = circular_noise(generator, 15)
    basis = np.linalg.qr(np.stack([vector, slope], axis=1)).Q
    across -= basis @ (basis.conj().T @ across)
    across /= np.linalg.norm(across)
    signal = np.sqrt(1.0 - outside) * vector + np.sqrt(outside) * across
    covariance = np.eye(15, dtype=complex) + 10.0 * signal[:, None] * signal.conj()
    found = music_bearings(covariance, 1, POSITIONS, WAVENUMBER)
    assert len(found) == kept
    assert np.allclose(found, 0.2, atol=0.02)


@pytest.mark.parametrize("angle_deg", [-84.0, -75.0, 80.0, 84.0])
def test_sources_near_the_axis_of_a_line_are_found(angle_deg: float) -> None:
    positions = line_array(15, 0.4)  # so that endfire is not the same from both ends
    vectors = steering_vectors(positions, np.radians([angle_deg]), WAVENUMBER)
    covariance = 5.0 * vectors @ vectors.conj().T + np.eye(15)
    found = music_bearings(covariance, 1, positions, WAVENUMBER)
    assert np.degrees(found) == pytest.approx([angle_deg], abs=0.01)


@pytest.mark.parametrize("angle_deg", [-175.0, -90.0, 0.0, 120.0, 175.0])
def test_a_circle_is_looked_at_all_round(angle_deg: float) -> None:
    around = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    positions = np.stack([0.5 * np.sin(around), 0.5 * np.cos(around), 0.0 * around], axis=1)
    vectors = steering_vectors(positions, np.radians([angle_deg]), WAVENUMBER)
    covariance = 5.0 * vectors @ vectors.conj().T + np.eye(8)
    found = np.degrees(music_bearings(covariance, 1, positions, WAVENUMBER))
    assert found == pytest.approx([angle_deg], abs=1e-4)


@pytest.mark.parametrize("end", [0, -1])
def test_sources_in_the_first_and_last_direction_of_the_grid_are_found(end: int) -> None:
    around = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    positions = np.stack([0.5 * np.sin(around), 0.5 * np.cos(around), 0.0 * around], axis=1)
    angle = angle_grid(positions, WAVENUMBER).angles[[end]]
    vectors = steering_vectors(positions, angle, WAVENUMBER)
    found = music_bearings(5.0 * vectors @ vectors.conj().T + np.eye(8), 1, positions, WAVENUMBER)
    assert found == pytest.approx(angle, abs=1e-9)


def test_of_more_valleys_than_sources_the_deepest_are_taken() -> None:
    angles = np.radians([-40.0, 10.0])
    vectors = steering_vectors(POSITIONS, angles, WAVENUMBER)
    covariance = vectors @ np.diag([100.0, 1.0]) @ vectors.conj().T + np.eye(15)
    found = music_bearings(covariance, 1, POSITIONS, WAVENUMBER)
    assert np.degrees(found) == pytest.approx([-40.0], abs=0.1)


@pytest.mark.parametrize("positions", [POSITIONS, POSITIONS[::-1].copy(), POSITIONS[[0, 1, 2, 4]]])
@pytest.mark.parametrize("factor", [None, np.eye(15), np.diag(np.linspace(1.0, 2.0, 15))])
def test_the_null_spectrum_is_the_share_outside_of_the_signal_subspace(
    positions: np.ndarray, factor: np.ndarray | None
) -> None:
    """Of one source: 0 at its angle, elsewhere 1 less the squared cosine to its steering vector."""
    n = len(positions)
    factor = None if factor is None else factor[:n, :n].astype(complex)
    weights = np.ones(n) if factor is None else 1.0 / np.diag(factor).real
    source = steering_vectors(positions, np.array([0.3]), WAVENUMBER) * weights[:, None]
    unit = source / np.linalg.norm(source)
    spectrum = NullSpectrum(positions, WAVENUMBER, unit, factor)
    grid = angle_grid(positions, WAVENUMBER)
    others = steering_vectors(positions, grid.angles, WAVENUMBER) * weights[:, None]
    cosine = np.abs(unit.conj().T @ others)[0] / np.linalg.norm(others, axis=0)
    np.testing.assert_allclose(spectrum.on_grid(grid), 1.0 - cosine**2, atol=1e-9)
    np.testing.assert_allclose(spectrum.at(grid.angles), 1.0 - cosine**2, atol=1e-9)
    assert spectrum.at(np.array([0.3])) == pytest.approx([0.0], abs=1e-12)


def test_a_newton_step_leads_to_the_floor_and_is_none_on_it() -> None:
    source = steering_vectors(POSITIONS, np.array([0.3]), WAVENUMBER) / np.sqrt(15.0)
    spectrum = NullSpectrum(POSITIONS, WAVENUMBER, source, None)
    step = spectrum.newton_step(np.array([0.3, 0.301, 0.299]))
    assert step == pytest.approx([0.0, -1e-3, 1e-3], abs=1e-5)
    # Half of seven metres from the centre, a wavelength of one metre.
    assert spectrum.curvature == pytest.approx(7.0 * np.pi)


def test_noise_from_ahead_pulls_no_angle() -> None:
    angles = np.arcsin([-0.3, 0.2])
    vectors = steering_vectors(POSITIONS, angles, WAVENUMBER)
    noise = noise_from_ahead()
    found = music_bearings(vectors @ vectors.conj().T + noise, 2, POSITIONS, WAVENUMBER, noise)
    assert found == pytest.approx(angles, abs=1e-7)


def test_a_newton_step_is_the_slope_over_the_whole_bend() -> None:
    """By differences of the null spectrum, away from the floor, of a line and of an oval."""
    around = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    circle = np.stack([0.5 * np.sin(around), 0.3 * np.cos(around), 0.0 * around], axis=1)
    for positions, off in ((POSITIONS, 0.015), (circle, 0.1)):
        source = steering_vectors(positions, np.array([0.3]), WAVENUMBER)
        spectrum = NullSpectrum(positions, WAVENUMBER, source / np.linalg.norm(source), None)
        left, middle, right = spectrum.at(0.3 + off + np.array([-1e-4, 0.0, 1e-4]))
        expected = -0.5 * 1e-4 * (right - left) / (left - 2.0 * middle + right)
        step = spectrum.newton_step(np.array([0.3 + off]))
        assert step == pytest.approx([expected], rel=1e-4)


@pytest.mark.parametrize("n_snapshots", [10, 60])
@pytest.mark.parametrize("colour", [None, np.diag(np.linspace(0.6, 1.4, 15)).astype(complex)])
def test_bearings_in_windows_are_those_of_their_covariances(
    n_snapshots: int, colour: ComplexArray | None
) -> None:
    """Fewer snapshots than elements are looked at by their own products."""
    generator = np.random.default_rng(7)
    static = np.broadcast_to(np.deg2rad([-30.0, -22.0, 25.0]), (n_snapshots, 3))
    windows = snapshots_of(generator, static, [15.0, 5.0, 0.0], batch=(6,))
    windows[3] = snapshots_of(generator, static[:, :1], 15.0)
    found = bearings_in_snapshots(windows, 3, POSITIONS, WAVENUMBER, colour)
    assert found.shape == (6, 3)
    for window, bearings in zip(windows, found, strict=True):
        alone = music_bearings(sample_covariance(window), 3, POSITIONS, WAVENUMBER, colour)
        assert bearings[: len(alone)] == pytest.approx(alone, abs=1e-9)
        assert np.isnan(bearings[len(alone) :]).all()
    assert np.isnan(found[3]).any() and np.isfinite(found[0]).all()
