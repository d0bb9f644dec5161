"""Array geometry: element positions, wavenumber, steering vectors and their derivatives.

Positions are in the frame of the array, whose x axis points from the first element to the last.
The arrival angle theta is measured from array broadside, positive towards increasing element x,
so that the unit vector towards a source in the horizontal plane is ``(sin theta, cos theta)``.
A plane wave from theta gives element m the phase

    k ((x_m - x_ref) sin theta + (y_m - y_ref) cos theta),

which for a line array (y = 0) is the ``exp(+j k (x_m - x_0) sin theta)`` of Ryu, Park and Choi
(2003), eq. 5: with the analytic signal ``exp(+j omega t)`` the element nearer the source leads.
A line array measures a cone; z is not used by arrivals in the horizontal plane.

An array does not change: what is asked of its positions again and again is kept.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.records.arrays import ComplexArray, FloatArray

PhaseReference = Literal["first_element", "array_centre"]

PHASE_REFERENCES: tuple[str, ...] = ("first_element", "array_centre")


def line_array(n_elements: int, spacing: float) -> FloatArray:
    """Return the positions of a uniform line array along x, starting at 0.

    Parameters
    ----------
    n_elements : int
        Number of elements.
    spacing : float
        Between neighbours, m.

    Returns
    -------
    ndarray, shape (n_elements, 3)
        Element positions, m.
    """
    positions = np.zeros((n_elements, 3))
    positions[:, 0] = spacing * np.arange(n_elements)
    return positions


def wavenumber(frequency: float, sound_speed: float) -> float:
    """Return the wavenumber 2 pi f / c, rad/m."""
    return 2.0 * np.pi * frequency / sound_speed


def steering_vectors(
    positions: FloatArray,
    arrival_angles: ArrayLike,
    wavenumber: float,
    phase_reference: str = "first_element",
) -> ComplexArray:
    """Return plane-wave steering vectors.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    arrival_angles : array_like, shape (..., n_angles)
        rad from broadside.
    wavenumber : float
        rad/m.
    phase_reference : {"first_element", "array_centre"}
        Point of zero phase. The centre is the mean of the positions.

    Returns
    -------
    ndarray, shape (..., n_elements, n_angles), complex
        Steering vectors in the columns, pure numbers.

    References
    ----------
    Ryu, Park, Choi (2003), eq. 5.
    """
    angles = np.asarray(arrival_angles, dtype=np.float64)[..., None, :]
    offset = _offsets(positions, phase_reference)
    return np.exp(1j * wavenumber * _projection(offset, angles))


def steering_derivatives(
    positions: FloatArray,
    arrival_angles: ArrayLike,
    wavenumber: float,
    phase_reference: str = "first_element",
) -> ComplexArray:
    """Return the derivatives of the steering vectors with respect to the arrival angle.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    arrival_angles : array_like, shape (..., n_angles)
        rad from broadside.
    wavenumber : float
        rad/m.
    phase_reference : {"first_element", "array_centre"}
        As in :func:`steering_vectors`.

    Returns
    -------
    ndarray, shape (..., n_elements, n_angles), complex
        1/rad.
    """
    return steering_pair(positions, arrival_angles, wavenumber, phase_reference)[1]


def steering_pair(
    positions: FloatArray,
    arrival_angles: ArrayLike,
    wavenumber: float,
    phase_reference: str = "first_element",
) -> tuple[ComplexArray, ComplexArray]:
    """Return steering vectors and their derivatives, computed together.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    arrival_angles : array_like, shape (..., n_angles)
        rad from broadside.
    wavenumber : float
        rad/m.
    phase_reference : {"first_element", "array_centre"}
        As in :func:`steering_vectors`.

    Returns
    -------
    vectors, derivatives : ndarray, shape (..., n_elements, n_angles), complex
        Pure numbers and 1/rad.
    """
    angles = np.asarray(arrival_angles, dtype=np.float64)[..., None, :]
    offset = _offsets(positions, phase_reference)
    vectors = np.exp(1j * wavenumber * _projection(offset, angles))
    slope = offset[:, :1] * np.cos(angles) - offset[:, 1:2] * np.sin(angles)
    return vectors, (1j * wavenumber * slope) * vectors


def aperture(positions: FloatArray) -> float:
    """Return the largest distance between two elements, m.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    """
    if len(positions) < 2:
        return 0.0
    if is_line(positions):
        return float(np.ptp(positions[:, 0]))
    return float(max(np.linalg.norm(positions - point, axis=1).max() for point in positions))


def is_line(positions: FloatArray) -> bool:
    """Return whether all elements lie on a line parallel to the x axis of the array.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    """
    return _is_line(np.ascontiguousarray(positions, np.float64).tobytes())


@lru_cache(maxsize=64)
def _is_line(position_bytes: bytes) -> bool:
    positions = np.frombuffer(position_bytes).reshape(-1, 3)
    across = positions[:, 1:] - positions[0, 1:]
    length = np.ptp(positions[:, 0])
    return bool(np.abs(across).max() <= 1e-6 * max(length, np.finfo(float).tiny))


def is_uniform_line(positions: FloatArray) -> bool:
    """Return whether the elements are a line array with equal spacing, in order of x.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    """
    return _is_uniform_line(np.ascontiguousarray(positions, np.float64).tobytes())


@lru_cache(maxsize=64)
def _is_uniform_line(position_bytes: bytes) -> bool:
    positions = np.frombuffer(position_bytes).reshape(-1, 3)
    if len(positions) < 2 or not is_line(positions):
        return False
    steps = np.diff(positions[:, 0])
    return bool(steps[0] > 0 and np.abs(steps - steps[0]).max() <= 1e-6 * steps[0])


def variance_along(positions: FloatArray) -> float:
    """Return the variance of the x coordinates of the elements, m^2.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    """
    return _variance_along(np.ascontiguousarray(positions, np.float64).tobytes())


@lru_cache(maxsize=64)
def _variance_along(position_bytes: bytes) -> float:
    return float(np.frombuffer(position_bytes).reshape(-1, 3)[:, 0].var())


def largest_spacing(positions: FloatArray) -> float:
    """Return the largest distance from an element to its nearest neighbour, m.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    """
    if len(positions) < 2:
        return 0.0
    if is_line(positions):
        steps = np.diff(np.sort(positions[:, 0]))
        padded = np.concatenate([[np.inf], steps, [np.inf]])
        return float(np.minimum(padded[:-1], padded[1:]).max())
    distances = [np.sort(np.linalg.norm(positions - point, axis=1))[1] for point in positions]
    return float(max(distances))


def has_grating_lobes(positions: FloatArray, wavenumber: float) -> bool:
    """Return whether the element spacing exceeds half a wavelength, so that bearings alias.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    """
    return largest_spacing(positions) * wavenumber > np.pi * (1.0 + 1e-6)


def beamwidth(positions: FloatArray, wavenumber: float) -> float:
    """Return the broadside beamwidth wavelength / aperture, rad (pi for a single point).

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    """
    length = aperture(positions)
    if length == 0.0:
        return float(np.pi)
    return float(min(2.0 * np.pi / (wavenumber * length), np.pi))


def _offsets(positions: FloatArray, phase_reference: str) -> FloatArray:
    if phase_reference == "first_element":
        return positions - positions[0]
    if phase_reference == "array_centre":
        return positions - positions.mean(axis=0)
    raise ValueError(
        f"phase_reference is {phase_reference!r}; it must be one of {', '.join(PHASE_REFERENCES)}."
    )


def _projection(offset: FloatArray, angles: FloatArray) -> FloatArray:
    along = offset[:, :1] * np.sin(angles)
    if not offset[:, 1].any():
        return along
    return along + offset[:, 1:2] * np.cos(angles)
