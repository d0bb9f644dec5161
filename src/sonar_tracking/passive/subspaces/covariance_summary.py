"""The rectangular sample covariance published with each estimate, and what is read from it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.filtering.eigenpairs import Eigenpairs
from sonar_tracking.geometry import is_uniform_line
from sonar_tracking.passive.sources.mdl import signal_counts
from sonar_tracking.passive.sources.moving_source_counting import (
    count_moving_sources,
    sample_covariance,
)
from sonar_tracking.passive.sources.steering_error import steering_error_floor, with_steering_error
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray
from sonar_tracking.records.bearings import ArraySnapshots

_SNAPSHOTS_PER_ELEMENT = 2


@dataclass(frozen=True)
class CovarianceSummary:
    """A sample covariance and its eigenvalues.

    Attributes
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex, or None
        X X^H / n_snapshots and the floor of the steering errors, linear power; None = no
        snapshots.
    n_snapshots : int
        Snapshots in it.
    eigenvalues : ndarray, shape (..., n_elements), or empty
        Linear power, descending.
    eigenvectors : ndarray, shape (n_elements, n_elements), complex, or None
        In their order, in columns, pure numbers; None = not known.
    noise_power : ndarray, shape (...)
        Linear, mean of the smallest eigenvalues (of the whitened covariance in coloured
        noise).
    rank, source_count : int
        MDL on the raw (whitened) and on the smoothed covariance; -1 = not estimated.
    """

    covariance: ComplexArray | None = None
    n_snapshots: int = 0
    eigenvalues: FloatArray = field(default_factory=lambda: np.empty(0))
    eigenvectors: ComplexArray | None = None
    noise_power: FloatArray = field(default_factory=lambda: np.array(np.nan))
    rank: int = -1
    source_count: int = -1


def summarise_windows(
    snapshots: ComplexArray,
    n_columns: int,
    header: ArraySnapshots,
    whitening: ComplexArray | None,
    maximum_rate: float,
    steering_error: float | FloatArray = 0.0,
    sampled: ComplexArray | None = None,
    eigenpairs: Eigenpairs | None = None,
) -> list[CovarianceSummary]:
    """Return the covariance of each of several windows and what it says of noise and sources.

    Parameters
    ----------
    snapshots : ndarray, shape (n_windows, ..., n_snapshots, n_elements), complex
        Newest snapshots of each window, linear amplitude.
    n_columns : int
        Signal eigenvalues to leave out of the noise power; 0 = take the number found by MDL.
    header : ArraySnapshots
        Array and frequency; its noise covariance is that of all windows, or of each.
    whitening : ndarray, shape (..., n_elements, n_elements), complex, or None
        Inverse Cholesky factor of that covariance, pure numbers; None = white noise.
    maximum_rate : float
        Fastest bearing that must not be counted twice, rad/s.
    steering_error : float or ndarray, shape (n_windows,)
        Relative rms error of the steering vectors, pure number.
    sampled : ndarray, shape (n_windows, n_elements, n_elements), complex, optional
        Sample covariances, linear power, if they are known already.
    eigenpairs : Eigenpairs, optional
        Of them, if they are known already and the noise is white.

    Returns
    -------
    list of CovarianceSummary
        One a window. Ranks and counts are estimated of single runs only, no dimensions in between,
        and only of enough snapshots: twice the elements for the rank, a dozen for the count.
    """
    n_windows, n_snapshots, n_elements = len(snapshots), *snapshots.shape[-2:]
    if n_snapshots == 0:
        return [CovarianceSummary()] * n_windows
    sampled = sample_covariance(snapshots) if sampled is None else sampled
    steering_error = np.reshape(steering_error, (-1, *(1,) * (snapshots.ndim - 3)))
    covariance = with_steering_error(sampled, steering_error, header.noise_covariance)
    eigenvalues, signal_values = _eigenvalues(
        snapshots, sampled, covariance, whitening, steering_error, eigenpairs
    )
    ranks = counts = np.full(n_windows, -1)
    if snapshots.ndim == 3 and n_snapshots >= _SNAPSHOTS_PER_ELEMENT * n_elements:
        ranks = signal_counts(signal_values, n_snapshots)
    if snapshots.ndim == 3 and is_uniform_line(header.element_positions):
        counts = count_moving_sources(
            snapshots, sampled, eigenvalues, header, maximum_rate, n_columns == 0, steering_error
        )
    # Vectors of a covariance with a floor may differ by rounding.
    vectors = None if eigenpairs is None or steering_error.any() else eigenpairs.vectors
    signals = n_columns or np.maximum(np.maximum(ranks, counts), 0)
    powers = _noise_powers(signal_values, np.broadcast_to(signals, n_windows), n_snapshots)
    return _each_window(n_snapshots, covariance, eigenvalues, vectors, powers, ranks, counts)


def _each_window(
    n_snapshots: int,
    covariance: ComplexArray,
    eigenvalues: FloatArray,
    vectors: ComplexArray | None,
    powers: list[FloatArray],
    ranks: IntArray,
    counts: IntArray,
) -> list[CovarianceSummary]:
    return [
        CovarianceSummary(
            covariance=covariance[window],
            n_snapshots=n_snapshots,
            eigenvalues=eigenvalues[window],
            eigenvectors=None if vectors is None else vectors[window],
            noise_power=power,
            rank=int(ranks[window]),
            source_count=int(counts[window]),
        )
        for window, power in enumerate(powers)
    ]


def _eigenvalues(
    snapshots: ComplexArray,
    sampled: ComplexArray,
    covariance: ComplexArray,
    whitening: ComplexArray | None,
    steering_error: FloatArray,
    eigenpairs: Eigenpairs | None,
) -> tuple[FloatArray, FloatArray]:
    """Return the eigenvalues of the covariance and of the whitened one, both with the floor."""
    floor = steering_error_floor(sampled, steering_error)[..., None]
    if eigenpairs is None:
        eigenvalues = _descending_eigenvalues(snapshots, sampled) + floor
    else:
        eigenvalues = eigenpairs.values + floor
    if whitening is None:
        return eigenvalues, eigenvalues
    signal_values = _descending_eigenvalues(snapshots @ np.swapaxes(whitening, -1, -2)) + floor
    if steering_error.any():
        loaded = np.linalg.eigvalsh(covariance)[..., ::-1]
        eigenvalues = np.asarray(loaded, dtype=np.float64)
    return eigenvalues, signal_values


def _descending_eigenvalues(
    snapshots: ComplexArray, covariance: ComplexArray | None = None
) -> FloatArray:
    """Return the eigenvalues of the sample covariance; of fewer snapshots by their own products."""
    n_snapshots, n_elements = snapshots.shape[-2:]
    if n_snapshots >= n_elements:
        values = np.linalg.eigvalsh(
            sample_covariance(snapshots) if covariance is None else covariance
        )
        return np.asarray(values[..., ::-1], dtype=np.float64)
    products = snapshots.conj() @ np.swapaxes(snapshots, -1, -2) / n_snapshots
    padded = np.zeros((*snapshots.shape[:-2], n_elements))
    padded[..., :n_snapshots] = np.linalg.eigvalsh(products)[..., ::-1]
    return padded


def _noise_powers(
    eigenvalues: FloatArray, n_signals: IntArray, n_snapshots: int
) -> list[FloatArray]:
    """Return the mean of the other eigenvalues of each window, NaN if there are none."""
    most = min(eigenvalues.shape[-1], n_snapshots)
    return [
        np.full(own.shape[:-1], np.nan) if n >= most else np.asarray(own[..., n:].mean(axis=-1))
        for own, n in zip(eigenvalues, n_signals.tolist(), strict=True)
    ]
