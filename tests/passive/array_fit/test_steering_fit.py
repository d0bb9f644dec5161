"""Protects after how many covariances an array is said not to fit plane waves at all."""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.array_fit.steering_fit import SteeringFit
from sonar_tracking.passive.array_fit.strong_sources import StrongSources, strong_sources
from sonar_tracking.records.arrays import ComplexArray

N_ELEMENTS = 9
POSITIONS = np.column_stack([np.arange(N_ELEMENTS) * 0.5, np.zeros((N_ELEMENTS, 2))])
WAVENUMBER = 2.0 * np.pi
NO_ERRORS = np.ones(N_ELEMENTS)


def strong_source(vector: ComplexArray) -> StrongSources:
    """Return the source of a covariance with this vector and little noise."""
    covariance = 1000.0 * np.outer(vector, vector.conj()) + np.eye(N_ELEMENTS)
    found = strong_sources(covariance[None], 500, POSITIONS, WAVENUMBER, np.arange(N_ELEMENTS))[0]
    assert found is not None
    return found


PLANE_WAVE = strong_source(steering_vectors(POSITIONS, [0.3], WAVENUMBER)[:, 0])
NO_PLANE_WAVE = strong_source(np.exp(2.0j * np.arange(N_ELEMENTS) ** 2))


def test_two_covariances_in_a_row_say_that_no_plane_wave_fits() -> None:
    fit = SteeringFit()
    for source, fits in (
        (NO_PLANE_WAVE, True),
        (PLANE_WAVE, True),
        (NO_PLANE_WAVE, True),
        (NO_PLANE_WAVE, False),
        (PLANE_WAVE, True),
    ):
        fit = fit.after(source, NO_ERRORS)
        assert fit.fits == fits
        assert fit.error == 0.0
