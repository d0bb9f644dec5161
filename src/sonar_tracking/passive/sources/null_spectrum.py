"""The null spectrum of signal subspaces: what of a steering vector lies outside of each.

f(theta) = |E_n^H a(theta)|^2 / |a(theta)|^2 of the (whitened) steering vectors a, with E_n the
eigenvectors that are not among those of the signals; zero where a source is.

References
----------
R. O. Schmidt, "Multiple emitter location and signal parameter estimation", IEEE Trans. Antennas
and Propagation 34(3), 1986.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.sources.angle_grid import AngleGrid, adjoint, column_power
from sonar_tracking.passive.sources.noise_of_windows import of_windows
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IndexArray

_TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class NullSpectrum:
    """The null spectrum f of a signal subspace.

    Attributes
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    signal_vectors : ndarray, shape (..., n_elements, n_sources), complex
        Orthonormal eigenvectors of (whitened) covariances, pure numbers.
    factor : ndarray, shape (..., n_elements, n_elements), complex, or None
        Cholesky factor of the noise covariance, of all or of each, pure numbers; None = white.
    """

    positions: FloatArray
    wavenumber: float
    signal_vectors: ComplexArray
    factor: ComplexArray | None

    @cached_property
    def across(self) -> FloatArray:
        """Positions about their centre, m, shape (2, n_elements, 1)."""
        places = self.positions[:, :2]
        return np.asarray((places - places.sum(axis=0) / len(places)).T[:, :, None])

    @cached_property
    def curvature(self) -> float:
        """Largest phase of an element, rad: how far a Newton step is from the floor."""
        return self.wavenumber * float(np.abs(self.across).max())

    def of(self, rows: IndexArray) -> NullSpectrum:
        """Return the spectra of some of several covariances.

        Parameters
        ----------
        rows : ndarray of int, shape (n_kept,)
            Which of them.
        """
        if len(rows) == len(self.signal_vectors):
            return self
        factor = of_windows(self.factor, rows)
        return replace(self, signal_vectors=self.signal_vectors[rows], factor=factor)

    def on_grid(self, grid: AngleGrid) -> FloatArray:
        """Return f at all angles of a grid.

        Parameters
        ----------
        grid : AngleGrid
            Of the same array.

        Returns
        -------
        ndarray, shape (..., n_angles)
            Pure numbers from 0, in the signal subspace, to 1, orthogonal to it.
        """
        if self.factor is None:
            power = float(len(self.positions))
            return np.maximum(power - grid.power(self.signal_vectors), 0.0) / power
        # With whitened steering vectors L^-1 a: |E^H L^-1 a|^2 and |L^-1 a|^2.
        whitening = adjoint(np.asarray(np.linalg.inv(self.factor), dtype=np.complex128))
        whole = grid.power(whitening)
        inside = grid.power(whitening @ self.signal_vectors)
        return np.asarray(np.maximum(whole - inside, 0.0) / whole)

    def at(self, angles: FloatArray) -> FloatArray:
        """Return f at some angles.

        Parameters
        ----------
        angles : ndarray, shape (..., n)
            rad.

        Returns
        -------
        ndarray, shape (..., n)
            Pure numbers, as on the grid.
        """
        vectors = self._white(steering_vectors(self.positions, angles, self.wavenumber))
        inside = adjoint(self.signal_vectors) @ vectors
        power = column_power(vectors)
        return np.maximum(power - column_power(inside), 0.0) / power

    def newton_step(self, angles: FloatArray) -> FloatArray:
        """Return the Newton step of |E_n^H a|^2 at each angle.

        Parameters
        ----------
        angles : ndarray, shape (..., n)
            rad.

        Returns
        -------
        ndarray, shape (..., n)
            To be added to the angles, rad.
        """
        n_angles = angles.shape[-1]
        vectors, first, second = self._steering(angles)
        # Outside of the signal subspace: y = E_n E_n^H a, u = E_n E_n^H a'.
        outside = self._outside(np.concatenate([vectors, first], axis=-1))
        y, u = outside[..., :n_angles].conj(), outside[..., n_angles:]
        slope = (y * u).real.sum(axis=-2)
        square = column_power(u)
        # The whole second derivative is |u|^2 + Re(y^H a''); far from the floor it may be negative.
        bend = np.maximum(square + (y * second).real.sum(axis=-2), 0.5 * square)
        return -slope / np.maximum(bend, _TINY)

    def _steering(self, angles: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Return steering vectors with the phase of the array centre, and two derivatives."""
        x, y = self.across
        sine, cosine = np.sin(angles)[..., None, :], np.cos(angles)[..., None, :]
        phase, slope = x * sine, x * cosine
        if y.any():
            phase, slope = phase + y * cosine, slope - y * sine
        phase, slope = self.wavenumber * phase, self.wavenumber * slope
        vectors = np.exp(1j * phase)
        first, second = 1j * slope * vectors, -(slope**2 + 1j * phase) * vectors
        if self.factor is None:
            return vectors, first, second
        return self._white(vectors), self._white(first), self._white(second)

    def _white(self, vectors: ComplexArray) -> ComplexArray:
        if self.factor is None:
            return vectors
        return np.asarray(np.linalg.solve(self.factor, vectors), dtype=np.complex128)

    def _outside(self, vectors: ComplexArray) -> ComplexArray:
        return vectors - self.signal_vectors @ (adjoint(self.signal_vectors) @ vectors)
