"""What an estimate tells of sources at known angles: their powers, and how well it tells them.

Covariance and signal-to-noise ratios of the sources, the variance of their angles by the Fisher
information, the power along each angle that is orthogonal to all others, and which angles the
array does not tell apart. Measurement, existence and start of bearing tracks all read from here.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import beamwidth, steering_vectors, wavenumber
from sonar_tracking.passive.directions.signal_subspace import noise_factor, whitened_covariance
from sonar_tracking.passive.performance.fisher_information import (
    source_covariance,
    stochastic_fisher_information,
)
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

PRIOR_VARIANCE = 900.0 * float(np.deg2rad(1.0) ** 2)
"""Variance of a bearing of which the data say nothing, rad^2: bounds R at crossings and endfire."""

_LEAST_NOISE_SHARE = 1e-12

_SEPARABLE = 1e-8

_TINY = float(np.finfo(float).tiny)


def estimated_sources(
    estimates: SubspaceEstimates, angles: FloatArray, rates: FloatArray
) -> ComplexArray | None:
    """Return the covariance of the sources at the tracked angles.

    Parameters
    ----------
    estimates : SubspaceEstimates
        With sample covariance and noise power.
    angles, rates : ndarray, shape (..., n_targets)
        At the stamp, rad and rad/s; the angles are moved to the middle of the covariance.

    Returns
    -------
    ndarray, shape (..., n_targets, n_targets), complex, or None
        Linear power; None when the estimates carry no covariance.
    """
    if estimates.covariance is None or not np.isfinite(estimates.noise_power).all():
        return None
    return source_covariance(
        estimates.covariance,
        estimates.element_positions,
        angles + rates * estimates.covariance_time_offset,
        wavenumber(estimates.center_frequency, estimates.sound_speed),
        estimates.noise_power,
        estimates.noise_covariance,
    )


def signal_to_noise_ratios(
    estimates: SubspaceEstimates, sources: ComplexArray | None, shape: tuple[int, ...]
) -> FloatArray:
    """Return the signal-to-noise ratio of each target.

    Parameters
    ----------
    estimates : SubspaceEstimates
        With the noise power.
    sources : ndarray, shape (..., n_targets, n_targets), complex, or None
        Covariance of the sources, linear power; None = not known.
    shape : tuple of int
        Of the result.

    Returns
    -------
    ndarray, shape (..., n_targets)
        Linear, of one element; NaN when it is not known.
    """
    if sources is None:
        return np.full(shape, np.nan)
    powers = np.diagonal(sources, axis1=-2, axis2=-1).real
    return np.asarray(powers / _noise_power(estimates)[..., None])


def fisher_variance(
    estimates: SubspaceEstimates,
    angles: FloatArray,
    sources: ComplexArray | None,
    snapshots: float,
) -> FloatArray:
    """Return the variance of each angle, the diagonal of (J + I / 900 deg^2)^-1.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Array, frequency and noise.
    angles : ndarray, shape (..., n_targets)
        rad.
    sources : ndarray, shape (..., n_targets, n_targets), complex, or None
        Covariance of the sources, linear power; None gives NaN.
    snapshots : float
        Independent snapshots behind the measurement.

    Returns
    -------
    ndarray, shape (..., n_targets)
        rad^2.
    """
    if sources is None:
        return np.full(angles.shape, np.nan)
    information = stochastic_fisher_information(
        estimates.element_positions,
        angles,
        wavenumber(estimates.center_frequency, estimates.sound_speed),
        sources,
        _noise_power(estimates),
        snapshots,
        estimates.noise_covariance,
    )
    identity = np.broadcast_to(np.eye(angles.shape[-1]), information.shape)
    bound = np.linalg.solve(information + identity / PRIOR_VARIANCE, identity)
    return np.array(np.diagonal(bound, axis1=-2, axis2=-1), dtype=np.float64)


def power_ratios(estimates: SubspaceEstimates, angles: FloatArray) -> FloatArray:
    """Return the power along each angle, orthogonal to all others, over that of the noise.

    Parameters
    ----------
    estimates : SubspaceEstimates
        With covariance and noise power.
    angles : ndarray, shape (..., n)
        In the middle of the covariance, rad.

    Returns
    -------
    ndarray, shape (..., n)
        Linear; NaN without a covariance or noise power.
    """
    covariance, power = estimates.covariance, estimates.noise_power
    known = power > 0.0
    if angles.shape[-1] == 0 or covariance is None or not known.any():
        return np.full(angles.shape, np.nan)
    number = wavenumber(estimates.center_frequency, estimates.sound_speed)
    vectors = steering_vectors(estimates.element_positions, angles, number)
    if estimates.noise_covariance is not None:
        factor = noise_factor(estimates.noise_covariance)
        vectors = np.asarray(np.linalg.solve(factor, vectors), dtype=np.complex128)
        covariance = whitened_covariance(covariance, factor)
    # Row n of the pseudoinverse is the part of vector n orthogonal to the others, over its power.
    rows = np.linalg.pinv(vectors, rcond=_SEPARABLE)
    along = np.einsum("...nm,...mk,...nk->...n", rows, covariance, rows.conj()).real
    own_power = np.where(known, power, np.nan)[..., None]
    return np.asarray(along / (np.abs(rows) ** 2).sum(axis=-1) / own_power)


def unresolved(
    angles: FloatArray, others: FloatArray, estimates: SubspaceEstimates, share: float = 0.5
) -> BoolArray:
    """Return which pairs of angles are closer than a share of the beamwidth.

    Parameters
    ----------
    angles, others : ndarray, shape (..., n) and (..., m)
        rad.
    estimates : SubspaceEstimates
        Array and frequency.
    share : float
        Of the beamwidth.

    Returns
    -------
    ndarray of bool, shape (..., n, m)
        True where the pair is not told apart.
    """
    number = wavenumber(estimates.center_frequency, estimates.sound_speed)
    apart = np.abs(np.sin(angles)[..., :, None] - np.sin(others)[..., None, :])
    return np.asarray(apart <= share * beamwidth(estimates.element_positions, number))


def _noise_power(estimates: SubspaceEstimates) -> FloatArray:
    least = np.array(_TINY)
    if estimates.covariance is not None:
        trace = np.trace(estimates.covariance, axis1=-2, axis2=-1).real
        share = _LEAST_NOISE_SHARE * trace / len(estimates.element_positions)
        least = np.maximum(least, share)
    return np.maximum(estimates.noise_power, least)
