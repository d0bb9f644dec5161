"""Array geometry: phase convention, derivatives, phase reference, aliasing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sonar_tracking import geometry

POSITIONS = geometry.line_array(15, 0.5)
WAVENUMBER = geometry.wavenumber(1500.0, 1500.0)
SCATTERED = np.array([[0.0, 0.0, 0.0], [0.4, 0.3, 0.0], [1.0, -0.2, 0.0], [1.3, 0.5, 0.0]])

angles = st.floats(-1.5, 1.5)


def test_element_nearer_the_source_leads() -> None:
    # theta > 0 is towards increasing x, so the phase grows with x.
    vector = geometry.steering_vectors(POSITIONS, [0.3], WAVENUMBER)[:, 0]
    steps = np.angle(vector[1:] / vector[:-1])
    assert np.allclose(steps, np.pi * np.sin(0.3), atol=1e-12)


@given(angles, st.sampled_from(geometry.PHASE_REFERENCES), st.booleans())
@settings(max_examples=50, deadline=None)
def test_derivative_is_the_slope(angle: float, reference: str, line: bool) -> None:
    positions = POSITIONS if line else SCATTERED
    step = 1e-6
    ahead = geometry.steering_vectors(positions, [angle + step], WAVENUMBER, reference)
    behind = geometry.steering_vectors(positions, [angle - step], WAVENUMBER, reference)
    slope = geometry.steering_derivatives(positions, [angle], WAVENUMBER, reference)
    assert np.allclose((ahead - behind) / (2 * step), slope, atol=1e-6 * np.abs(slope).max())


@given(angles)
@settings(max_examples=30, deadline=None)
def test_phase_references_differ_by_one_phase_only(angle: float) -> None:
    first = geometry.steering_vectors(SCATTERED, [angle], WAVENUMBER, "first_element")[:, 0]
    centre = geometry.steering_vectors(SCATTERED, [angle], WAVENUMBER, "array_centre")[:, 0]
    assert np.allclose(first / first[0], centre / centre[0])
    assert first[0] == pytest.approx(1.0)


def test_any_array_follows_the_travel_time_of_a_plane_wave() -> None:
    angle = 0.7
    towards_source = np.array([np.sin(angle), np.cos(angle), 0.0])
    lead = (SCATTERED - SCATTERED[0]) @ towards_source
    expected = np.exp(1j * WAVENUMBER * lead)
    assert np.allclose(geometry.steering_vectors(SCATTERED, [angle], WAVENUMBER)[:, 0], expected)


def test_angles_may_have_leading_dimensions() -> None:
    many = np.linspace(-1.0, 1.0, 24).reshape(2, 3, 4)
    vectors, slopes = geometry.steering_pair(POSITIONS, many, WAVENUMBER)
    assert vectors.shape == slopes.shape == (2, 3, 15, 4)
    single = geometry.steering_vectors(POSITIONS, many[1, 2], WAVENUMBER)
    assert np.array_equal(vectors[1, 2], single)


def test_half_a_wavelength_is_the_limit_of_the_spacing() -> None:
    assert not geometry.has_grating_lobes(POSITIONS, WAVENUMBER)
    assert geometry.has_grating_lobes(geometry.line_array(15, 0.51), WAVENUMBER)
    assert not geometry.has_grating_lobes(SCATTERED * 0.5, WAVENUMBER)
    assert geometry.has_grating_lobes(SCATTERED * 2.0, WAVENUMBER)


def test_shape_of_an_array_is_recognised() -> None:
    uneven = POSITIONS.copy()
    uneven[3, 0] += 0.1
    assert geometry.is_uniform_line(POSITIONS)
    assert geometry.is_line(uneven)
    assert not geometry.is_uniform_line(uneven)
    assert not geometry.is_line(SCATTERED)
    assert geometry.aperture(POSITIONS) == pytest.approx(7.0)
    assert geometry.aperture(SCATTERED) == pytest.approx(np.hypot(1.3, 0.5))
    assert geometry.beamwidth(POSITIONS, WAVENUMBER) == pytest.approx(1.0 / 7.0)


def test_a_single_element_has_no_aperture() -> None:
    one = geometry.line_array(1, 0.5)
    assert geometry.aperture(one) == geometry.largest_spacing(one) == 0.0
    assert geometry.beamwidth(one, WAVENUMBER) == pytest.approx(np.pi)


def test_unknown_phase_reference_is_named() -> None:
    with pytest.raises(ValueError, match="first_element, array_centre"):
        geometry.steering_vectors(POSITIONS, [0.0], WAVENUMBER, "middle")
