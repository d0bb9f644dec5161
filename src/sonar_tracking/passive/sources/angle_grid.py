"""A grid of arrival angles that no valley of a null spectrum falls through, and powers on it.

The grid is even in sin(theta) for a line array and in theta for any other one. On a uniform line
the power |v^H a(theta)|^2 at all angles of the grid is one Fourier transform of the correlation of
v along the line; other arrays are multiplied with the steering vectors of the grid. Grids are kept
from call to call, since an array does not change.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sonar_tracking.geometry import beamwidth, is_line, is_uniform_line, steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IndexArray

_POINTS_PER_BEAM = 16
_LARGEST_KEPT = 4_000_000
"""Entries of the largest matrix of steering vectors that is kept, 64 MB."""

_ANGLES_AT_ONCE = 1024


@dataclass(frozen=True)
class UniformLineGrid:
    """The grid of a uniform line array.

    Attributes
    ----------
    angles : ndarray, shape (n_angles,)
        Arrival angles, rad, ascending.
    shift : ndarray, shape (n_elements,), complex
        Steering vector of the first angle, pure numbers.
    length : int
        Angles in one period of the phase between neighbouring elements.
    period : ndarray, shape (n_angles,), int
        Which of them each angle is.
    """

    angles: FloatArray
    shift: ComplexArray
    length: int
    period: IndexArray

    def power(self, vectors: ComplexArray) -> FloatArray:
        """Return the power of all steering vectors in a subspace, sum_c |v_c^H a(theta)|^2.

        Parameters
        ----------
        vectors : ndarray, shape (..., n_elements, n_columns), complex
            v_c in the columns, pure numbers.

        Returns
        -------
        ndarray, shape (..., n_angles)
            Pure numbers.
        """
        n_elements = len(self.shift)
        spectra = np.fft.fft(adjoint(vectors) * self.shift, 2 * n_elements)
        correlation = np.fft.ifft((spectra.real**2 + spectra.imag**2).sum(axis=-2))
        power = np.fft.irfft(correlation[..., :n_elements], self.length) * self.length
        return np.asarray(power[..., self.period])


@dataclass(frozen=True)
class SteeredGrid:
    """The grid of any other array.

    Attributes
    ----------
    angles : ndarray, shape (n_angles,)
        Arrival angles, rad, ascending.
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    steering : ndarray, shape (n_elements, n_angles), complex, or None
        Steering vectors, pure numbers; None = too many to be kept.
    """

    angles: FloatArray
    positions: FloatArray
    wavenumber: float
    steering: ComplexArray | None

    def power(self, vectors: ComplexArray) -> FloatArray:
        """Return the power of all steering vectors in a subspace, sum_c |v_c^H a(theta)|^2.

        Parameters
        ----------
        vectors : ndarray, shape (..., n_elements, n_columns), complex
            v_c in the columns, pure numbers.

        Returns
        -------
        ndarray, shape (..., n_angles)
            Pure numbers.
        """
        if self.steering is not None:
            return column_power(adjoint(vectors) @ self.steering)
        portions = np.array_split(self.angles, -(-len(self.angles) // _ANGLES_AT_ONCE))
        return np.concatenate(
            [
                column_power(
                    adjoint(vectors) @ steering_vectors(self.positions, portion, self.wavenumber)
                )
                for portion in portions
            ],
            axis=-1,
        )


AngleGrid = UniformLineGrid | SteeredGrid


def angle_grid(positions: FloatArray, wavenumber: float, rounded: bool = False) -> AngleGrid:
    """Return the grid of an array, finer than its beams by far.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    rounded : bool
        Whether a uniform line may have some angles more, as many as make their Fourier transform
        up to ten times as fast; bearings refined from there differ by rounding.
    """
    rounded = rounded and is_uniform_line(positions)
    return _kept(np.ascontiguousarray(positions).tobytes(), wavenumber, rounded)


@lru_cache(maxsize=6)
def _kept(position_bytes: bytes, wavenumber: float, rounded: bool) -> AngleGrid:
    positions = np.frombuffer(position_bytes).reshape(-1, 3)
    count = math.ceil(2.0 * _POINTS_PER_BEAM * np.pi / beamwidth(positions, wavenumber))
    if is_uniform_line(positions):
        return _uniform_line_grid(positions, wavenumber, count, rounded)
    middles = (np.arange(count) + 0.5) / count
    angles = np.pi * (2.0 * middles - 1.0)
    if is_line(positions):
        angles = np.arcsin(2.0 * middles - 1.0)
    kept = len(angles) * len(positions) <= _LARGEST_KEPT
    steering = steering_vectors(positions, angles, wavenumber) if kept else None
    return SteeredGrid(angles, positions, wavenumber, steering)


def _uniform_line_grid(
    positions: FloatArray, wavenumber: float, count: int, rounded: bool
) -> UniformLineGrid:
    n_elements = len(positions)
    between = wavenumber * float(np.ptp(positions[:, 0])) / (n_elements - 1)
    tolerance = 1e-9  # at half a wavelength one period of the phase is the whole grid
    length = max(math.ceil(np.pi * count / between - tolerance), 2 * n_elements)
    if rounded:
        length = _easily_transformed(length)
    step = 2.0 * np.pi / (length * between)
    n_angles = math.ceil(2.0 / step - 0.5)
    middles = (np.arange(n_angles) + 0.5) / n_angles
    sines = 2.0 * middles - 1.0 if n_angles == length else (np.arange(n_angles) + 0.5) * step - 1.0
    shift = np.exp(1j * between * (0.5 * step - 1.0) * np.arange(n_elements))
    return UniformLineGrid(np.arcsin(sines), shift, length, np.arange(n_angles) % length)


def _easily_transformed(length: int) -> int:
    """Return the next length whose only prime factors are 2, 3 and 5."""
    while True:
        rest = length
        for prime in (2, 3, 5):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return length
        length += 1


def column_power(vectors: ComplexArray) -> FloatArray:
    """Return the sum of squared magnitudes of each column.

    Parameters
    ----------
    vectors : ndarray, shape (..., n_rows, n_columns), complex
        Linear amplitude, or pure numbers.

    Returns
    -------
    ndarray, shape (..., n_columns)
        Linear power, or pure numbers.
    """
    return np.asarray((vectors.real**2 + vectors.imag**2).sum(axis=-2))


def adjoint(matrix: ComplexArray) -> ComplexArray:
    """Return the conjugate transpose of matrices, shape (..., n, m), in their unit."""
    return np.swapaxes(matrix, -1, -2).conj()
