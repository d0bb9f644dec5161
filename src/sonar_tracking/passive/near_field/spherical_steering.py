"""Spherical steering vectors: sources so near that their wavefronts are curved.

Angle theta and range r of a source are those at the centre of the array (the mean of the element
positions x_m, counted from there). With e = (sin theta, cos theta, 0), curvature u = 1 / r and
q_m = r_m / r = sqrt(1 - 2 u x_m.e + u^2 |x_m|^2) the wave at element m, over that at the centre, is

    a_m = exp(-j k d_m) / q_m,  d_m = r_m - r = (u |x_m|^2 - 2 x_m.e) / (q_m + 1),

exact at any range and without cancellation: u = 0 is the plane wave exp(+j k x_m.e) of
:func:`sonar_tracking.geometry.steering_vectors` with the centre as reference. For small u the
path bends by u (|x|^2 - (x.e)^2) / 2 (Fresnel). At the ends of a line of aperture D it reaches
lambda / 16 at broadside, a phase of pi / 8, at the Rayleigh distance 2 D^2 / lambda: nearer sources
should not be steered at with plane waves, farther ones tell nothing of their range.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.geometry import aperture
from sonar_tracking.records.arrays import ComplexArray, FloatArray


def rayleigh_distance(positions: FloatArray, wavenumber: float) -> float:
    """Return the range 2 aperture^2 / wavelength below which wavefronts are curved, m.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    """
    return aperture(positions) ** 2 * wavenumber / np.pi


def plane_wave_notice(
    distance: float, positions: FloatArray, wavenumber: float, culprit: str
) -> Notice | None:
    """Return the warning that a source is too near for plane waves, None if it is not.

    Parameters
    ----------
    distance : float
        Of the source from the array, m.
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    culprit : str
        Name of the source.
    """
    limit = rayleigh_distance(positions, wavenumber)
    if not distance < limit:
        return None
    return Notice(
        Severity.WARN,
        culprit,
        f"{culprit} is {distance:.3g} m away, nearer than 2 aperture^2 / wavelength = {limit:.3g} "
        "m: its wavefronts are curved and a plane wave misses its bearing; steer with spherical "
        "waves, or use fewer neighbouring elements.",
    )


def spherical_vectors(
    positions: FloatArray, angles: ArrayLike, curvatures: ArrayLike, wavenumber: float
) -> ComplexArray:
    """Return spherical-wave steering vectors.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        m.
    angles : array_like, shape (..., n_sources)
        Arrival angles at the centre of the array, rad from broadside.
    curvatures : array_like, shape (..., n_sources)
        1 / range from the centre, 1/m; 0 = plane wave.
    wavenumber : float
        rad/m.

    Returns
    -------
    ndarray, shape (..., n_elements, n_sources), complex
        Steering vectors in the columns, pure numbers: 1 at the centre.
    """
    along, _, square, curvature = _coordinates(positions, angles, curvatures)
    ratio = np.sqrt(1.0 - 2.0 * curvature * along + curvature**2 * square)
    detour = (curvature * square - 2.0 * along) / (ratio + 1.0)
    return np.asarray(np.exp(-1j * wavenumber * detour) / ratio, dtype=np.complex128)


def spherical_derivatives(
    positions: FloatArray, angles: ArrayLike, curvatures: ArrayLike, wavenumber: float
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return the steering vectors and their derivatives by angle and by curvature.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        m.
    angles : array_like, shape (..., n_sources)
        Arrival angles at the centre of the array, rad from broadside.
    curvatures : array_like, shape (..., n_sources)
        1 / range from the centre, 1/m; 0 = plane wave.
    wavenumber : float
        rad/m.

    Returns
    -------
    vectors, by_angle, by_curvature : ndarray, shape (..., n_elements, n_sources), complex
        Pure numbers, 1/rad and m.
    """
    along, across, square, curvature = _coordinates(positions, angles, curvatures)
    ratio = np.sqrt(1.0 - 2.0 * curvature * along + curvature**2 * square)
    numerator = curvature * square - 2.0 * along
    vectors = np.exp(-1j * wavenumber * numerator / (ratio + 1.0)) / ratio
    ratio_by_angle = -curvature * across / ratio
    ratio_by_curvature = (curvature * square - along) / ratio
    detour_by_angle = -across / ratio
    detour_by_curvature = (
        square / (ratio + 1.0) - numerator * ratio_by_curvature / (ratio + 1.0) ** 2
    )
    by_angle = vectors * (-1j * wavenumber * detour_by_angle - ratio_by_angle / ratio)
    by_curvature = vectors * (-1j * wavenumber * detour_by_curvature - ratio_by_curvature / ratio)
    return vectors, by_angle, by_curvature


def _coordinates(
    positions: FloatArray, angles: ArrayLike, curvatures: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return x.e, its derivative by the angle, |x|^2 and u, all (..., n_elements, n_sources)."""
    angle = np.asarray(angles, dtype=np.float64)[..., None, :]
    curvature = np.asarray(curvatures, dtype=np.float64)[..., None, :]
    offsets = positions - positions.mean(axis=0)
    x, y = offsets[:, :1], offsets[:, 1:2]
    along = x * np.sin(angle) + y * np.cos(angle)
    across = x * np.cos(angle) - y * np.sin(angle)
    square = (offsets**2).sum(axis=1)[:, None]
    return along, across, square, curvature
