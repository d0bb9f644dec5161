"""MDL, minimum description length: how many sources, by the raw and by the smoothed covariance.

The raw covariance tells the rank (coherent sources count as one), the forward-backward smoothed
one the number of sources, coherent or not.

References
----------
M. Wax, T. Kailath, "Detection of signals by information theoretic criteria", IEEE Trans. ASSP
33(2), 1985, eq. 17.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.geometry import variance_along
from sonar_tracking.passive.directions.signal_subspace import whitened_covariance
from sonar_tracking.passive.sources.spatial_smoothing import forward_backward_smoothed
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray

LEAST_COUNTING_SNAPSHOTS = 12
"""Fewest snapshots that sources are counted on."""

_LARGEST_SUB_ARRAY = 128

_EPSILON, _TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)


def minimum_description_length(eigenvalues: NDArray[np.floating], n_snapshots: int) -> int:
    """Return the number of signal eigenvalues by the MDL criterion.

    Parameters
    ----------
    eigenvalues : ndarray, shape (M,)
        Of a sample covariance, linear power, descending.
    n_snapshots : int
        N, independent snapshots in the covariance.
    """
    return int(signal_counts(eigenvalues, n_snapshots))


def signal_counts(eigenvalues: NDArray[np.floating], n_snapshots: int) -> IntArray:
    """Return the number of signal eigenvalues of each of several covariances by the MDL criterion.

    MDL(k) = N (M - k) ln(mean / geometric mean of the M - k smallest) + (k / 2)(2M - k) ln N, least
    over k = 0 ... M - 1.

    Parameters
    ----------
    eigenvalues : ndarray, shape (..., M)
        Of sample covariances, linear power, descending. Zero ones, of silent elements or
        because there are fewer snapshots than M, are left out.
    n_snapshots : int
        N, independent snapshots in each covariance.

    Returns
    -------
    ndarray of int, shape (...)
        One a covariance.
    """
    floor = np.maximum(eigenvalues[..., :1], 0.0) * _EPSILON + _TINY
    n_eigenvalues = eigenvalues.shape[-1]
    least = n_eigenvalues * floor
    if (eigenvalues[..., -1:] > least).all():
        return _shortest_description(eigenvalues[..., :n_snapshots], n_snapshots)
    above = (eigenvalues > least).sum(axis=-1)
    counts = np.maximum(np.minimum(above, n_snapshots), 1)
    values, found = np.maximum(eigenvalues, floor), np.zeros_like(counts)
    for count in set(counts.ravel().tolist()):
        rows = counts == count
        found[rows] = _shortest_description(values[rows][:, :count], n_snapshots)
    return found


def _shortest_description(values: NDArray[np.floating], n_snapshots: int) -> IntArray:
    """Return the k of the least MDL(k), shape (...), of eigenvalues (..., count) above zero."""
    remaining, scaled, penalty = _penalty(values.shape[-1], n_snapshots)
    mean = values[..., ::-1].cumsum(axis=-1)[..., ::-1] / remaining
    log_mean = np.log(values)[..., ::-1].cumsum(axis=-1)[..., ::-1] / remaining
    return np.asarray((scaled * (np.log(mean) - log_mean) + penalty).argmin(axis=-1))


@lru_cache(maxsize=256)
def _penalty(count: int, n_snapshots: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return M - k, N (M - k) and the penalty of every k; kept, since they recur."""
    k = np.arange(count, dtype=np.float64)
    remaining = count - k
    penalty = 0.5 * k * (2 * count - k) * np.log(n_snapshots)
    return remaining, n_snapshots * remaining, penalty


def smoothed_size(n_elements: int, n_snapshots: int) -> int:
    """Return the sub-array size used for counting: two thirds of the array, less when data is few.

    The sub-arrays that fit side by side give n_elements / size looks a snapshot; there should be
    as many looks as elements in a sub-array. Very large sub-arrays only cost time.
    """
    looks = math.isqrt(n_elements * n_snapshots)
    return max(2, min(round(2 * n_elements / 3), looks, _LARGEST_SUB_ARRAY))


def counting_snapshots(
    eigenvalues: NDArray[np.floating],
    n_snapshots: int,
    positions: FloatArray,
    wavenumber: float,
    largest_turn: FloatArray | float,
) -> IntArray:
    """Return how many snapshots to count sources on, so that a moving one counts once.

    A source of ratio s to the noise that turns by d during N snapshots spreads over a second
    eigenvalue of about s M (k d)^2 var(x) / 12, which MDL takes for another source when it exceeds
    the random spread sqrt(M / N) of the noise eigenvalues. Strong sources are therefore counted
    on fewer snapshots; they need no more.

    Parameters
    ----------
    eigenvalues : ndarray, shape (..., n_elements)
        Of the sample covariance, linear power, descending.
    n_snapshots : int
        Snapshots in it.
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    largest_turn : float or ndarray, shape (...)
        Largest change of a bearing between two snapshots, rad.

    Returns
    -------
    ndarray of int, shape (...)
        One a covariance.
    """
    strongest = eigenvalues[..., 0]
    count = min(eigenvalues.shape[-1], n_snapshots)
    noise = np.maximum(eigenvalues[..., count - max(count // 3, 1) : count].mean(axis=-1), 0.0)
    ratio = strongest / np.maximum(np.maximum(noise, strongest * 1e-9), _TINY)
    n = np.arange(1, n_snapshots + 1)
    turned = np.asarray(largest_turn)[..., None] * n
    spread = wavenumber**2 * variance_along(positions) * turned**2 / 12.0 * ratio[..., None]
    allowed = np.where(spread < 0.5 * np.sqrt(len(positions) / n), n, 0).max(axis=-1)
    return np.minimum(np.maximum(allowed, LEAST_COUNTING_SNAPSHOTS), n_snapshots)


def source_count(
    covariance: ComplexArray, n_snapshots: int, noise_covariance: ComplexArray | None = None
) -> int:
    """Return the number of sources, coherent or not, seen by a uniform line array.

    Parameters
    ----------
    covariance : ndarray, shape (n_elements, n_elements), complex
        Sample covariance, linear power, not whitened.
    n_snapshots : int
        Snapshots in it.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, optional
        As in :func:`source_counts`, pure numbers.
    """
    return int(source_counts(covariance, n_snapshots, noise_covariance))


def source_counts(
    covariance: ComplexArray, n_snapshots: int, noise_covariance: ComplexArray | None = None
) -> IntArray:
    """Return the number of sources, coherent or not, in several covariances of a uniform line.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Sample covariance, linear power, not whitened (whitening breaks the shift
        structure).
    n_snapshots : int
        Snapshots in it.
    noise_covariance : ndarray, shape (..., n_elements, n_elements), complex, optional
        Of all or of each, pure numbers, positive; None = white. Smoothed like the covariance and
        then whitened with: the shift structure is no longer needed there.

    Returns
    -------
    ndarray of int, shape (...)
        One a covariance.
    """
    size = smoothed_size(covariance.shape[-1], n_snapshots)
    smoothed = forward_backward_smoothed(covariance, size)
    if noise_covariance is not None:
        factor = np.linalg.cholesky(forward_backward_smoothed(noise_covariance, size))
        smoothed = whitened_covariance(smoothed, np.asarray(factor, dtype=np.complex128))
    values = np.linalg.eigvalsh(smoothed)[..., ::-1]
    return signal_counts(values, n_snapshots)
