"""One Kalman filter a target, each with a measurement of its own.

The measurement of a target starts from its own prediction (an angular innovation, or a fit from
the predictions), so that every target knows which measurement is its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict, update
from sonar_tracking.passive.bearings.bearing_filters import FilterUpdate
from sonar_tracking.passive.bearings.bearing_measurement import (
    BearingMeasurement,
    measure_in_subspaces,
    nearest_subspace,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.projection_measurement import measure_by_projection
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray, IndexArray
from sonar_tracking.records.bearings import SubspaceEstimates

Measured = tuple[BearingMeasurement | None, tuple[Notice, ...]]
Measure = Callable[
    [BearingTrackerConfiguration, SubspaceEstimates, FloatArray, FloatArray, ComplexArray | None],
    Measured,
]
"""Takes parameters, estimates, predicted angles and rates (..., n_targets) in rad and rad/s, and
the covariance of the sources; returns the measured bearings, or None and why there are none."""


@dataclass(frozen=True)
class IndependentFilters:
    """Filters of targets that share no covariance.

    Attributes
    ----------
    configuration : BearingTrackerConfiguration
        Parameters.
    measure : callable
        Measures the bearings of all targets, see :data:`Measure`.
    """

    configuration: BearingTrackerConfiguration
    measure: Measure

    def start(self, targets: KalmanState) -> KalmanState:
        """Return the filters of some targets: the targets themselves."""
        return targets

    def extend(self, filters: KalmanState, targets: KalmanState) -> KalmanState:
        """Return the filters with more targets."""
        return KalmanState(
            mean=np.concatenate([filters.mean, targets.mean], axis=-2),
            covariance=np.concatenate([filters.covariance, targets.covariance], axis=-3),
        )

    def keep(self, filters: KalmanState, rows: IndexArray) -> KalmanState:
        """Return the filters of some of the targets, by their rows, shape (n_kept,)."""
        return KalmanState(filters.mean[..., rows, :], filters.covariance[..., rows, :, :])

    def predict(self, filters: KalmanState, interval: float) -> KalmanState:
        """Return the filters after an interval in s."""
        density = self.configuration.process_noise_density
        return predict(
            filters, transition_matrix(interval), process_noise_matrix(density, interval)
        )

    def update(
        self,
        filters: KalmanState,
        estimates: SubspaceEstimates,
        sources: ComplexArray | None,
        excess: FloatArray | None = None,
    ) -> FilterUpdate:
        """Measure every target and return the filters after it.

        Parameters
        ----------
        filters : KalmanState
            Predicted to the stamp of the estimate.
        estimates : SubspaceEstimates
            What was measured.
        sources : ndarray, shape (..., n_targets, n_targets), complex, or None
            Covariance of the sources at the predictions, linear power; None = not known.
        excess : ndarray, shape (..., n_targets), optional
            Of faint sources, pure numbers: not used, these filters hold none.
        """
        measurement, notices = self._measure(filters, estimates, sources)
        if measurement is None:
            return FilterUpdate(filters, None, notices)
        corrected = update(
            filters,
            measurement.angle[..., None],
            np.array([[1.0, -measurement.age]]),
            measurement.variance[..., None, None],
        )
        return FilterUpdate(corrected.state, measurement, notices)

    def coasted(self, filters: KalmanState, predicted: KalmanState, rows: BoolArray) -> KalmanState:
        """Return the filters with some targets, by a mask, shape (..., n), as predicted."""
        return KalmanState(
            np.where(rows[..., None], predicted.mean, filters.mean),
            np.where(rows[..., None, None], predicted.covariance, filters.covariance),
        )

    def targets(self, filters: KalmanState) -> KalmanState:
        """Return angle and rate of each target."""
        return filters

    def _measure(
        self,
        filters: KalmanState,
        estimates: SubspaceEstimates,
        sources: ComplexArray | None,
    ) -> Measured:
        angles, rates = filters.mean[..., 0], filters.mean[..., 1]
        measurement, notices = self.measure(self.configuration, estimates, angles, rates, sources)
        if measurement is not None and not np.isfinite(measurement.variance).all():
            text = (
                "The variance of the measurements is not known without a sample covariance; set "
                "covariance_snapshots of the subspace estimator above source_count, or "
                "measurement_variance_deg2 above zero."
            )
            return None, (Notice(Severity.ERROR, "measurement variance", text),)
        return measurement, notices


def one_subspace_filters(configuration: BearingTrackerConfiguration) -> IndependentFilters:
    """Return filters that measure in the one subspace at the sample time (``ryu``)."""
    return IndependentFilters(configuration, _measure_in_one_subspace)


def fused_subspace_filters(configuration: BearingTrackerConfiguration) -> IndependentFilters:
    """Return filters that measure in all adjacent subspaces (``ml_fusion``)."""
    return IndependentFilters(configuration, _measure_in_all_subspaces)


def projection_filters(configuration: BearingTrackerConfiguration) -> IndependentFilters:
    """Return filters that measure by a fit to the block covariance (``coherent``)."""
    return IndependentFilters(configuration, measure_by_projection)


def _measure_in_one_subspace(
    configuration: BearingTrackerConfiguration,
    estimates: SubspaceEstimates,
    angles: FloatArray,
    rates: FloatArray,
    sources: ComplexArray | None,
) -> Measured:
    if len(estimates.time_offsets):
        estimates = nearest_subspace(estimates)
    return _measure_in_all_subspaces(configuration, estimates, angles, rates, sources)


def _measure_in_all_subspaces(
    configuration: BearingTrackerConfiguration,
    estimates: SubspaceEstimates,
    angles: FloatArray,
    rates: FloatArray,
    sources: ComplexArray | None,
) -> Measured:
    if not len(estimates.time_offsets):
        text = "No subspace at this sample time; the tracks are predicted only."
        return None, (Notice(Severity.WARN, "subspace", text),)
    return measure_in_subspaces(configuration, estimates, angles, rates, sources), ()
