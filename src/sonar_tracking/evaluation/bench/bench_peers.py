"""Plain codings that the product's are measured against.

These are what one writes from a textbook, with nothing rearranged. They serve as the peer in the
bench and, in the tests, as an independent coding.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.sources.angle_grid import angle_grid
from sonar_tracking.records.arrays import ComplexArray, FloatArray


def textbook_past(data: ComplexArray, n_columns: int, forgetting_factor: float) -> ComplexArray:
    """Track the signal subspace with PAST, one snapshot at a time.

    Parameters
    ----------
    data : ndarray, shape (n_snapshots, n_elements), complex
        Snapshots, linear amplitude.
    n_columns : int
        Dimension of the subspace.
    forgetting_factor : float
        Per snapshot.

    Returns
    -------
    ndarray, shape (n_elements, n_columns), complex
        Basis after the last snapshot, pure numbers.

    References
    ----------
    Yang, "Projection approximation subspace tracking", 1995, table I.
    """
    basis = np.eye(data.shape[1], n_columns, dtype=complex)
    inverse = np.eye(n_columns, dtype=complex)
    for snapshot in data:
        projected = basis.conj().T @ snapshot
        weighted = inverse @ projected
        gain = weighted / (forgetting_factor + np.vdot(projected, weighted))
        inverse = (inverse - np.outer(gain, weighted.conj())) / forgetting_factor
        inverse = (inverse + inverse.conj().T) / 2
        basis = basis + np.outer(snapshot - basis @ projected, gain.conj())
    return basis


def eigenvectors_each_snapshot(
    data: ComplexArray, n_columns: int, forgetting_factor: float
) -> ComplexArray:
    """Track the signal subspace by an eigendecomposition at every snapshot.

    Parameters
    ----------
    data : ndarray, shape (n_snapshots, n_elements), complex
        Snapshots, linear amplitude.
    n_columns : int
        Dimension of the subspace.
    forgetting_factor : float
        Per snapshot.

    Returns
    -------
    ndarray, shape (n_elements, n_columns), complex
        Basis after the last snapshot, pure numbers.
    """
    n_elements = data.shape[1]
    covariance = np.zeros((n_elements, n_elements), dtype=complex)
    basis = np.eye(n_elements, n_columns, dtype=complex)
    for snapshot in data:
        newest = np.outer(snapshot, snapshot.conj())
        covariance = forgetting_factor * covariance + (1 - forgetting_factor) * newest
        basis = np.linalg.eigh(covariance).eigenvectors[:, -n_columns:]
    return basis


def eigenvectors_each_period(data: ComplexArray, n_columns: int, period: int) -> ComplexArray:
    """Estimate the signal subspace of every period from its sample covariance alone.

    Parameters
    ----------
    data : ndarray, shape (n_snapshots, n_elements), complex
        Snapshots, linear amplitude.
    n_columns : int
        Dimension of the subspace.
    period : int
        Snapshots in a period.

    Returns
    -------
    ndarray, shape (n_elements, n_columns), complex
        Basis of the last period, pure numbers.
    """
    basis = np.eye(data.shape[1], n_columns, dtype=complex)
    for first in range(0, len(data), period):
        block = data[first : first + period]
        covariance = block.T @ block.conj() / len(block)
        basis = np.linalg.eigh(covariance).eigenvectors[:, -n_columns:]
    return basis


def naive_music(
    covariance: ComplexArray, n_sources: int, positions: FloatArray, wavenumber: float
) -> FloatArray:
    """Find arrival angles with MUSIC: all eigenvectors, all steering vectors of the grid.

    Parameters
    ----------
    covariance : ndarray, shape (n_elements, n_elements), complex
        Sample covariance, linear power.
    n_sources : int
        Dimension of the signal subspace.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.

    Returns
    -------
    ndarray, shape (n_found,)
        The highest peaks on the grid of the product, rad, ascending; nothing is refined.
    """
    angles = angle_grid(positions, wavenumber).angles
    noise = np.linalg.eigh(covariance).eigenvectors[:, :-n_sources]
    vectors = steering_vectors(positions, angles, wavenumber)
    spectrum = 1.0 / (np.abs(noise.conj().T @ vectors) ** 2).sum(axis=0)
    inner = spectrum[1:-1]
    peaks = 1 + np.flatnonzero((inner > spectrum[:-2]) & (inner >= spectrum[2:]))
    highest = peaks[np.argsort(spectrum[peaks])[-n_sources:]]
    return np.sort(angles[highest])
