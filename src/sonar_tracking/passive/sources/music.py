"""MUSIC: arrival angles from one sample covariance, by a grid and its refinement.

The steering vectors of the sources are orthogonal to the noise eigenvectors E_n of the
(whitened) covariance, so that f(theta) = |E_n^H a(theta)|^2 / |a(theta)|^2 is least there. The
grid is fine enough to fall into the valley of each resolved source; Gauss-Newton steps inside a
grid cell then find its floor. A valley that stays shallow is not taken for a source.

References
----------
R. O. Schmidt, "Multiple emitter location and signal parameter estimation", IEEE Trans. Antennas
and Propagation 34(3), 1986.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.geometry import beamwidth, is_line, steering_pair, steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IndexArray

_POINTS_PER_BEAM = 16
_REFINEMENT_STEPS = 8
_ANGLES_AT_ONCE = 1024

SHALLOWEST_VALLEY = 0.3
"""Null spectrum above which a valley is no source: less than 70 % of its steering vector lies in
the signal subspace. Of 100 snapshots of 5 resolved sources on 15 elements it is 0.04 at -5 dB and
below 0.15 (99 %) at -8 dB; an unresolved pair leaves a shallow valley anywhere, as echoes do."""


@dataclass(frozen=True)
class _Pencil:
    """What the null spectrum is computed from."""

    positions: FloatArray
    wavenumber: float
    signal_vectors: ComplexArray
    factor: ComplexArray | None

    def null_spectrum(self, angles: FloatArray) -> FloatArray:
        """Return f at angles of shape (n,)."""
        # In portions: the steering vectors of a whole grid would fill the memory.
        portions = np.array_split(angles, -(-len(angles) // _ANGLES_AT_ONCE) or 1)
        return np.concatenate([self._null_spectrum(portion) for portion in portions])

    def _null_spectrum(self, angles: FloatArray) -> FloatArray:
        vectors = self._white(steering_vectors(self.positions, angles, self.wavenumber))
        inside = self.signal_vectors.conj().T @ vectors
        power = _column_power(vectors)
        return np.maximum(power - _column_power(inside), 0.0) / power

    def newton_step(self, angles: FloatArray) -> FloatArray:
        """Return the Gauss-Newton step of |E_n^H a|^2 at each angle, rad."""
        vectors, derivatives = steering_pair(
            self.positions, angles, self.wavenumber, "array_centre"
        )
        y, u = self._outside(self._white(vectors)), self._outside(self._white(derivatives))
        slope = (u.conj() * y).real.sum(axis=0)
        return -slope / np.maximum(_column_power(u), np.finfo(float).tiny)

    def _white(self, vectors: ComplexArray) -> ComplexArray:
        if self.factor is None:
            return vectors
        return np.asarray(np.linalg.solve(self.factor, vectors), dtype=np.complex128)

    def _outside(self, vectors: ComplexArray) -> ComplexArray:
        return vectors - self.signal_vectors @ (self.signal_vectors.conj().T @ vectors)


def music_bearings(
    covariance: ComplexArray,
    n_sources: int,
    positions: FloatArray,
    wavenumber: float,
    noise_covariance: ComplexArray | None = None,
) -> FloatArray:
    """Return the arrival angles of the sources that MUSIC resolves.

    Parameters
    ----------
    covariance : ndarray, shape (n_elements, n_elements), complex
        Sample covariance, linear power.
    n_sources : int
        Dimension of the signal subspace, below n_elements.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, optional
        Pure numbers; None = white noise.

    Returns
    -------
    ndarray, shape (n_resolved,)
        rad, ascending; at most n_sources, fewer when sources are not resolved.
    """
    factor = None
    white = covariance
    if noise_covariance is not None:
        factor = np.asarray(np.linalg.cholesky(noise_covariance), dtype=np.complex128)
        half = np.linalg.solve(factor, covariance)
        white = np.asarray(np.linalg.solve(factor, half.conj().T), dtype=np.complex128)
    signal_vectors = np.linalg.eigh(white).eigenvectors[:, -n_sources:]
    pencil = _Pencil(positions, wavenumber, np.asarray(signal_vectors), factor)
    grid = _grid(positions, wavenumber)
    spectrum = pencil.null_spectrum(grid)
    # The grid is cyclic: at half a wavelength both ends of a line array are the same wave.
    valley = (spectrum <= np.roll(spectrum, 1)) & (spectrum < np.roll(spectrum, -1))
    found = np.flatnonzero(valley)
    found = found[np.argsort(spectrum[found], kind="stable")][:n_sources]
    angles = np.sort(_refined(pencil, grid, found))
    return angles[pencil.null_spectrum(angles) < SHALLOWEST_VALLEY]


def _grid(positions: FloatArray, wavenumber: float) -> FloatArray:
    count = int(np.ceil(2.0 * _POINTS_PER_BEAM * np.pi / beamwidth(positions, wavenumber)))
    middles = (np.arange(count) + 0.5) / count
    if is_line(positions):
        return np.arcsin(2.0 * middles - 1.0)
    return np.pi * (2.0 * middles - 1.0)


def _refined(pencil: _Pencil, grid: FloatArray, found: IndexArray) -> FloatArray:
    angles = grid[found]
    low = grid[np.maximum(found - 1, 0)]
    high = grid[np.minimum(found + 1, len(grid) - 1)]
    for _ in range(_REFINEMENT_STEPS):
        if len(angles):
            angles = np.clip(angles + pencil.newton_step(angles), low, high)
    return angles


def _column_power(vectors: ComplexArray) -> FloatArray:
    return np.asarray((vectors.real**2 + vectors.imag**2).sum(axis=0))
