"""One measurement of every tracked bearing from the subspaces around a sample time.

Angular innovations at the predictions, fused over the subspaces (or taken from the one at the
sample time), with the variance the tracker is to believe.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.directions.angular_innovation import angular_innovations
from sonar_tracking.passive.directions.measurement_fusion import (
    correlated_variance_ratio,
    forgetting_factor_of,
    fused_measurement,
    independent_variance_ratio,
    mean_age,
)
from sonar_tracking.passive.performance.fisher_information import (
    source_covariance,
    stochastic_fisher_information,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

_SQUARE_DEGREE = float(np.deg2rad(1.0) ** 2)

PRIOR_VARIANCE = 900.0 * _SQUARE_DEGREE
"""Variance of a bearing of which the data say nothing, rad^2: bounds R at crossings and endfire."""

_LEAST_NOISE_SHARE = 1e-12


@dataclass(frozen=True)
class BearingMeasurement:
    """Measured bearings.

    Attributes
    ----------
    angle : ndarray, shape (..., n_targets)
        rad.
    innovation : ndarray, shape (..., n_targets)
        Measured minus predicted angle, rad.
    variance : ndarray, shape (..., n_targets)
        Of the measurement, rad^2; NaN = cannot be told, do not use it.
    age : float
        How long before the stamp the targets had the measured angles, s.
    """

    angle: FloatArray
    innovation: FloatArray
    variance: FloatArray
    age: float


def measured_bearings(
    configuration: BearingTrackerConfiguration,
    estimates: SubspaceEstimates,
    predicted_angles: FloatArray,
    predicted_rates: FloatArray,
    sources: ComplexArray | None,
) -> BearingMeasurement:
    """Return the measured bearings at one sample time.

    Parameters
    ----------
    configuration : BearingTrackerConfiguration
        Parameters of the tracker.
    estimates : SubspaceEstimates
        At least one subspace.
    predicted_angles, predicted_rates : ndarray, shape (..., n_targets)
        At the stamp, rad and rad/s.
    sources : ndarray, shape (..., n_targets, n_targets), complex, or None
        Covariance of the sources, for the variance from the Fisher information.

    References
    ----------
    Ryu, Park, Choi (2003), eqs. 6-14.
    """
    offsets = estimates.time_offsets
    basis = estimates.basis
    if configuration.method == "ryu":
        middle = int(np.argmin(np.abs(offsets)))
        offsets = offsets[middle : middle + 1]
        basis = basis[..., middle : middle + 1, :, :]
    beta = forgetting_factor_of(estimates.effective_snapshots)
    age = 0.0
    if configuration.lag_correction and configuration.variance_from_data:
        age = mean_age(beta) * estimates.sample_period - float(offsets.mean())
    angles = predicted_angles - age * predicted_rates if age else predicted_angles
    innovations = angular_innovations(
        basis,
        estimates.element_positions,
        angles,
        wavenumber(estimates.center_frequency, estimates.sound_speed),
        configuration.phase_reference,
    )
    if configuration.variance_from_data:
        variance = fisher_variance(estimates, angles, sources, estimates.effective_snapshots)
    else:
        variance = np.full(angles.shape, configuration.measurement_variance_deg2 * _SQUARE_DEGREE)
    if configuration.fused_variance == "independent":
        ratio = independent_variance_ratio(len(offsets))
    else:
        ratio = correlated_variance_ratio(offsets, estimates.sample_period, beta)
    innovation = fused_measurement(innovations)
    return BearingMeasurement(angles + innovation, innovation, ratio * variance, age)


def estimated_sources(
    estimates: SubspaceEstimates, angles: FloatArray, rates: FloatArray
) -> ComplexArray | None:
    """Return the covariance of the sources, or None when the estimates carry no covariance.

    Parameters
    ----------
    estimates : SubspaceEstimates
        With sample covariance and noise power.
    angles, rates : ndarray, shape (..., n_targets)
        At the stamp, rad and rad/s; the angles are moved to the middle of the covariance.
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
    """Return the linear signal-to-noise ratio of each target, NaN when it is not known."""
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
    """Return the diagonal of (J + I / 900 deg^2)^-1 at the given angles, rad^2.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Array, frequency and noise.
    angles : ndarray, shape (..., n_targets)
        rad.
    sources : ndarray, shape (..., n_targets, n_targets), complex, or None
        Covariance of the sources; None gives NaN.
    snapshots : float
        Independent snapshots behind the measurement.
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


def _noise_power(estimates: SubspaceEstimates) -> FloatArray:
    least = np.array(np.finfo(float).tiny)
    if estimates.covariance is not None:
        trace = np.trace(estimates.covariance, axis1=-2, axis2=-1).real
        share = _LEAST_NOISE_SHARE * trace / len(estimates.element_positions)
        least = np.maximum(least, share)
    return np.maximum(estimates.noise_power, least)
