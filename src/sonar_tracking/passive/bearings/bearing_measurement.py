"""One measurement of every tracked bearing from the subspaces around a sample time.

Angular innovations at the predictions, fused over the subspaces (or taken from the one at the
sample time), with the variance the tracker is to believe.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    SQUARE_DEGREE,
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
from sonar_tracking.passive.directions.sources_at_angles import fisher_variance
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates


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
        Of the measurement, rad^2; NaN = unknown, do not use it.
    age : float
        How long before the stamp the targets had the measured angles, s.
    """

    angle: FloatArray
    innovation: FloatArray
    variance: FloatArray
    age: float

    def without(self, rows: BoolArray) -> BearingMeasurement:
        """Return the measurement without some targets, by a mask, shape (..., n_targets)."""
        return BearingMeasurement(
            np.where(rows, np.nan, self.angle),
            np.where(rows, np.nan, self.innovation),
            np.where(rows, np.nan, self.variance),
            self.age,
        )


def measure_in_subspaces(
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
        At least one subspace; the innovations of all are fused.
    predicted_angles, predicted_rates : ndarray, shape (..., n_targets)
        At the stamp, rad and rad/s.
    sources : ndarray, shape (..., n_targets, n_targets), complex, or None
        Covariance of the sources, linear power, for the variance from the Fisher information.

    References
    ----------
    Ryu, Park, Choi (2003), eqs. 6-14.
    """
    offsets = estimates.time_offsets
    beta = forgetting_factor_of(estimates.effective_snapshots)
    age = 0.0
    if configuration.lag_correction and configuration.variance_from_data:
        age = mean_age(beta) * estimates.sample_period - float(offsets.mean())
    angles = predicted_angles - age * predicted_rates if age else predicted_angles
    innovations = angular_innovations(
        estimates.basis,
        estimates.element_positions,
        angles,
        wavenumber(estimates.center_frequency, estimates.sound_speed),
        configuration.phase_reference,
    )
    if configuration.variance_from_data:
        variance = fisher_variance(estimates, angles, sources, estimates.effective_snapshots)
    else:
        variance = np.full(angles.shape, configuration.measurement_variance_deg2 * SQUARE_DEGREE)
    if configuration.fused_variance == "independent":
        ratio = independent_variance_ratio(len(offsets))
    else:
        ratio = correlated_variance_ratio(offsets, estimates.sample_period, beta)
    innovation = fused_measurement(innovations)
    return BearingMeasurement(angles + innovation, innovation, ratio * variance, age)


def nearest_subspace(estimates: SubspaceEstimates) -> SubspaceEstimates:
    """Return the estimates with the one subspace that is nearest to the sample time.

    Parameters
    ----------
    estimates : SubspaceEstimates
        At least one subspace.
    """
    middle = int(np.argmin(np.abs(estimates.time_offsets)))
    return replace(
        estimates,
        basis=estimates.basis[..., middle : middle + 1, :, :],
        time_offsets=estimates.time_offsets[middle : middle + 1],
    )
