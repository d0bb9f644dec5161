"""One measurement of every tracked bearing from a fit to the block covariance.

The measured bearings are those that a few Gauss-Newton steps from the predictions give (Hwang et
al. 2005, eqs. 18-21): sources may be coherent and the noise coloured.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import Notice
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    SQUARE_DEGREE,
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.covariance_subspace import covariance_subspace
from sonar_tracking.passive.directions.projection_fit import ProjectionProblem, projection_fit
from sonar_tracking.passive.directions.sources_at_angles import fisher_variance
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates


def measure_by_projection(
    configuration: BearingTrackerConfiguration,
    estimates: SubspaceEstimates,
    predicted_angles: FloatArray,
    predicted_rates: FloatArray,
    sources: ComplexArray | None,
) -> tuple[BearingMeasurement | None, tuple[Notice, ...]]:
    """Return the measured bearings at one sample time, or None and why there are none.

    Parameters
    ----------
    configuration : BearingTrackerConfiguration
        Parameters of the tracker.
    estimates : SubspaceEstimates
        With a covariance.
    predicted_angles, predicted_rates : ndarray, shape (..., n_targets)
        At the stamp, rad and rad/s.
    sources : ndarray, shape (..., n_targets, n_targets), complex, or None
        Covariance of the sources, linear power, for the variance from the Fisher information.

    References
    ----------
    Hwang, Kim, Kim, Park, Nam (2005), eqs. 9-21.
    """
    subspace, notices = covariance_subspace(configuration, estimates, predicted_angles.shape[-1])
    if subspace is None:
        return None, notices
    age = 0.0
    if configuration.lag_correction and configuration.variance_from_data:
        age = -estimates.covariance_time_offset
    angles = predicted_angles - age * predicted_rates if age else predicted_angles
    problem = ProjectionProblem(
        subspace.steering_combinations(),
        estimates.element_positions,
        wavenumber(estimates.center_frequency, estimates.sound_speed),
    )
    measured = projection_fit(problem, angles)
    if configuration.variance_from_data:
        snapshots = float(estimates.covariance_snapshots)
        variance = fisher_variance(estimates, angles, sources, snapshots)
    else:
        given = configuration.measurement_variance_deg2 * SQUARE_DEGREE
        variance = np.full(angles.shape, given)
    return BearingMeasurement(measured, measured - angles, variance, age), notices
