"""Spatial noise covariances of few parameters, zero of which is white noise.

On a line array whose elements stand on an even grid the noise is stationary along the line, its
covariance a Toeplitz matrix, and the logarithm of its spectrum over the phase w between neighbours
is taken to be a short cosine series,

    ln f(w) = 2 sum_k (a_k cos k w + b_k sin k w),  r(n) = mean over w of f(w) exp(j n w),

which is positive whatever its coefficients are, and as smooth as noise from all round is; a plane
wave is a peak far too narrow for it. On any other array the covariance is a mixture of white noise
and of noise whose correlation falls with the distance between two elements,

    C_v = (1 - sum_k w_k) I + sum_k w_k exp(-|x_i - x_j| / l_k),  w_k >= 0.

References
----------
P. Bloomfield, "An exponential model for the spectrum of a scalar time series", Biometrika 60(2),
1973, for the series; J.-P. Le Cadre, "Parametric methods for spatial signal processing in the
presence of unknown colored noise fields", IEEE Trans. ASSP 37(7), 1989, for the use of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np

from sonar_tracking.geometry import is_line
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray

MOST_HARMONICS = 4
"""Cosines of the series: a correlation of 0.6 between neighbours is met within 5 per cent."""

_LARGEST_HARMONIC = 3.0
"""Of a coefficient: 26 dB between the most and the least of one cosine."""

_LARGEST_SHARE = 0.98
"""Of the noise that is not white: no covariance becomes singular."""

_REACHES = (1.5, 4.0)
"""Distances at which correlations fall to 1/e, over the distance to the nearest neighbour."""


class NoiseModel(Protocol):
    """Covariances by parameters, shape (..., n_parameters), pure numbers with trace n_elements."""

    @property
    def n_parameters(self) -> int:
        """How many parameters there are."""
        ...

    def covariance(self, parameters: FloatArray) -> ComplexArray:
        """Return the covariances, shape (..., n_elements, n_elements), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        ...

    def derivatives(self, parameters: FloatArray) -> ComplexArray:
        """Return derivatives, (..., n_parameters, n_elements, n_elements), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        ...

    def bounded(self, parameters: FloatArray) -> FloatArray:
        """Return the nearest parameters that are allowed, shape (..., n_parameters), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        ...


@dataclass(frozen=True)
class LineNoise:
    """Noise along a line array on an even grid.

    Attributes
    ----------
    lags : ndarray of int, shape (n_elements, n_elements)
        Steps of the grid from the second element of a pair to the first.
    n_harmonics : int
        Terms of the cosine series; there are twice as many parameters.
    """

    lags: IntArray
    n_harmonics: int

    @property
    def n_parameters(self) -> int:
        """How many parameters there are."""
        return 2 * self.n_harmonics

    @cached_property
    def series(self) -> FloatArray:
        """Derivatives of ln f by the parameters, shape (n_parameters, n_phases), pure numbers."""
        n_phases = 128
        while n_phases < 4 * int(self.lags.max()):
            n_phases *= 2
        phases = 2.0 * np.pi * np.arange(n_phases) / n_phases
        order = np.arange(1, self.n_harmonics + 1)[:, None] * phases
        return 2.0 * np.concatenate([np.cos(order), np.sin(order)])

    def covariance(self, parameters: FloatArray) -> ComplexArray:
        """Return the covariances, shape (..., n_elements, n_elements), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        return self._toeplitz(self._spectrum(parameters))

    def derivatives(self, parameters: FloatArray) -> ComplexArray:
        """Return derivatives, (..., n_parameters, n_elements, n_elements), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        spectrum = self._spectrum(parameters)[..., None, :]
        mean = (spectrum * self.series).mean(axis=-1, keepdims=True)
        return self._toeplitz(spectrum * (self.series - mean))

    def bounded(self, parameters: FloatArray) -> FloatArray:
        """Return the nearest parameters that are allowed, shape (..., n_parameters), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        return np.clip(parameters, -_LARGEST_HARMONIC, _LARGEST_HARMONIC)

    def _spectrum(self, parameters: FloatArray) -> FloatArray:
        spectrum = np.exp(_each_times(parameters, self.series))
        return np.asarray(spectrum / spectrum.mean(axis=-1, keepdims=True))

    def _toeplitz(self, spectrum: FloatArray) -> ComplexArray:
        return np.asarray(np.fft.ifft(spectrum, axis=-1)[..., self.lags])


@dataclass(frozen=True)
class DistanceNoise:
    """Noise whose correlation falls with the distance, on any array.

    Attributes
    ----------
    kernels : ndarray, shape (n_parameters, n_elements, n_elements)
        exp(-|x_i - x_j| / l_k), pure numbers.
    """

    kernels: FloatArray

    @property
    def n_parameters(self) -> int:
        """How many parameters there are."""
        return len(self.kernels)

    def covariance(self, parameters: FloatArray) -> ComplexArray:
        """Return the covariances, shape (..., n_elements, n_elements), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        identity, size = np.eye(self.kernels.shape[-1]), self.kernels.shape[-1]
        beyond = (self.kernels - identity).reshape(self.n_parameters, -1)
        shares = _each_times(parameters, beyond).reshape(*parameters.shape[:-1], size, size)
        return np.asarray(identity + shares, dtype=np.complex128)

    def derivatives(self, parameters: FloatArray) -> ComplexArray:
        """Return derivatives, (..., n_parameters, n_elements, n_elements), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        beyond = np.asarray(self.kernels - np.eye(self.kernels.shape[-1]), dtype=np.complex128)
        return np.broadcast_to(beyond, (*parameters.shape[:-1], *beyond.shape))

    def bounded(self, parameters: FloatArray) -> FloatArray:
        """Return the nearest parameters that are allowed, shape (..., n_parameters), pure numbers.

        Parameters
        ----------
        parameters : ndarray, shape (..., n_parameters)
            Pure numbers.
        """
        shares = np.maximum(parameters, 0.0)
        total = np.maximum(shares.sum(axis=-1, keepdims=True), 1e-9)
        return np.asarray(shares * np.minimum(1.0, _LARGEST_SHARE / total))


def noise_model(positions: FloatArray) -> NoiseModel | None:
    """Return the model of the noise of an array, None for one of too few elements.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    """
    return _noise_model(np.ascontiguousarray(positions, np.float64).tobytes())


@lru_cache(maxsize=16)
def _noise_model(position_bytes: bytes) -> NoiseModel | None:
    positions = np.frombuffer(position_bytes).reshape(-1, 3)
    n_harmonics = min(MOST_HARMONICS, len(positions) // 4)
    if n_harmonics == 0:
        return None
    if is_line(positions):
        lags = _grid_lags(positions[:, 0])
        if lags is not None:
            return LineNoise(lags, n_harmonics)
    distances = np.linalg.norm(positions[:, None] - positions, axis=-1)
    nearest = float(np.median(np.sort(distances, axis=-1)[:, 1]))
    if nearest == 0.0:
        return None
    return DistanceNoise(np.stack([np.exp(-distances / (r * nearest)) for r in _REACHES]))


def _each_times(parameters: FloatArray, matrix: FloatArray) -> FloatArray:
    """Return parameters times a matrix, one by one: the same bits however many there are."""
    return np.asarray((parameters[..., None, :] @ matrix)[..., 0, :])


def _grid_lags(places: FloatArray) -> IntArray | None:
    """Return the steps between the elements of a line, None if they are on no even grid."""
    step = float(np.abs(np.diff(np.sort(places))).min())
    if step == 0.0:
        return None
    lags = (places[:, None] - places) / step
    steps = np.rint(lags)
    if np.abs(lags - steps).max() > 1e-3 or steps.max() > 8 * len(places):
        return None
    return np.asarray(steps, dtype=np.int64)
