"""One filter over the angles and rates of all targets, behind the bearing tracker.

The state of n targets is [n angles, n rates]. A block measures the angles at its middle, half a
block before the sample time when it ends there, at the sample time when it is centred on it. Each
bearing has its level of process noise, from that of steady motion to the full one of a turn, and
never less than passing at its rate takes
(:mod:`sonar_tracking.passive.bearings.manoeuvre_detection`). When a turn is found out the update is
done again, with what the turn has added since it began.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.bearings.bearing_filters import FilterUpdate
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.estimate_subspace import block_subspace
from sonar_tracking.passive.bearings.joint_map_update import (
    joint_prediction,
    joint_process_noise,
    joint_update,
)
from sonar_tracking.passive.bearings.manoeuvre_detection import (
    HIGHEST_LEVEL,
    MEMORY,
    Manoeuvres,
    passing_process_noise,
    steady,
)
from sonar_tracking.passive.bearings.track_existence import unresolved
from sonar_tracking.passive.directions.weighted_subspace_fit import (
    SubspaceFit,
    weighted_subspace_fit,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

_LEAST_GAIN = 1e-9
"""Share of its variance that an angle must lose for the block to count as a measurement of it."""

_HELD_SHARE = 0.1
"""Of the steady process noise, while the array does not resolve a bearing from another."""


@dataclass(frozen=True)
class JointState(KalmanState):
    """Angles and rates of all targets.

    Attributes
    ----------
    mean : ndarray, shape (..., 2 n)
        rad, rad/s.
    covariance : ndarray, shape (..., 2 n, 2 n)
        rad^2, rad^2/s, rad^2/s^2.
    manoeuvres : Manoeuvres
        Which bearings turn.
    interval : float
        Since the last update, s.
    """

    manoeuvres: Manoeuvres
    interval: float = 0.0


@dataclass(frozen=True)
class JointFilters:
    """Filter of targets that share a covariance.

    Attributes
    ----------
    configuration : BearingTrackerConfiguration
        Parameters.
    """

    configuration: BearingTrackerConfiguration

    def started(self, targets: KalmanState) -> JointState:
        """Return the filter of uncorrelated targets."""
        batch = targets.mean.shape[:-2]
        nobody = JointState(np.empty((*batch, 0)), np.empty((*batch, 0, 0)), steady((*batch, 0)))
        return self.extended(nobody, targets)

    def extended(self, filters: JointState, targets: KalmanState) -> JointState:
        """Return the filter with more targets, uncorrelated with those there are."""
        n_old = filters.mean.shape[-1] // 2
        rows = _rows(n_old + targets.mean.shape[-2])
        mean = np.empty((*targets.mean.shape[:-2], rows.size))
        covariance = np.zeros((*mean.shape, rows.size))
        old, new = rows[:n_old].T.reshape(-1), rows[n_old:]
        mean[..., old], mean[..., new] = filters.mean, targets.mean
        covariance[..., old[:, None], old] = filters.covariance
        covariance[..., new[:, :, None], new[:, None, :]] = targets.covariance
        manoeuvres = filters.manoeuvres.extended(len(new))
        return JointState(mean, covariance, manoeuvres, filters.interval)

    def kept(self, filters: JointState, rows: NDArray[np.intp]) -> JointState:
        """Return the filter of some of the targets, with their correlations."""
        entries = _rows(filters.mean.shape[-1] // 2)[rows].T.reshape(-1)
        return JointState(
            filters.mean[..., entries],
            filters.covariance[..., entries[:, None], entries],
            filters.manoeuvres.kept(rows),
            filters.interval,
        )

    def predicted(self, filters: JointState, interval: float) -> JointState:
        """Return the filter after an interval in s."""
        state = joint_prediction(filters, interval, self._process_noise(filters))
        return replace(
            filters,
            mean=state.mean,
            covariance=state.covariance,
            interval=filters.interval + interval,
        )

    def updated(
        self,
        filters: JointState,
        estimates: SubspaceEstimates,
        sources: ComplexArray | None,
    ) -> FilterUpdate:
        """Return the filter after the block of an estimate; the sources are not used."""
        n_elements = len(estimates.element_positions)
        subspace, notices = block_subspace(self.configuration, estimates, n_elements - 1)
        if subspace is None:
            return FilterUpdate(filters, None, notices)
        number = wavenumber(estimates.center_frequency, estimates.sound_speed)

        def fit(angles: FloatArray) -> SubspaceFit:
            return weighted_subspace_fit(
                subspace,
                estimates.covariance_snapshots,
                estimates.element_positions,
                angles,
                number,
            )

        age = -estimates.covariance_time_offset
        corrected = joint_update(filters, age, fit)
        manoeuvres = self._manoeuvres(filters, corrected, estimates)
        begun = manoeuvres.level > filters.manoeuvres.level
        if begun.any():
            filters = self._turned(filters, begun, manoeuvres.level)
            corrected = joint_update(filters, age, fit)
        measurement = _equivalent_measurement(self.targets(filters), self.targets(corrected), age)
        state = JointState(corrected.mean, corrected.covariance, manoeuvres)
        return FilterUpdate(state, measurement, notices)

    def targets(self, filters: KalmanState) -> KalmanState:
        """Return angle and rate of each target."""
        rows = _rows(filters.mean.shape[-1] // 2)
        return KalmanState(
            mean=filters.mean[..., rows],
            covariance=filters.covariance[..., rows[:, :, None], rows[:, None, :]],
        )

    def _manoeuvres(
        self, before: JointState, after: KalmanState, estimates: SubspaceEstimates
    ) -> Manoeuvres:
        """Return which bearings turn, by the first update."""
        if self._constant_process_noise:
            return before.manoeuvres
        targets = self.targets(before)
        age = -estimates.covariance_time_offset
        middle = targets.mean[..., 0] - age * targets.mean[..., 1]
        close = unresolved(middle, middle, estimates) & ~np.eye(middle.shape[-1], dtype=bool)
        resolved = np.asarray(~close.any(axis=-1))
        return before.manoeuvres.updated(
            targets, self.targets(after), age, before.interval, resolved
        )

    def _turned(
        self, filters: JointState, begun: NDArray[np.bool_], level: NDArray[np.int_]
    ) -> JointState:
        """Return the prediction with what a turn has added to some bearings by now."""
        density = np.where(begun, self._densities(level), 0.0)
        added = joint_process_noise(begun.shape[-1], MEMORY, density)
        return replace(filters, covariance=filters.covariance + added)

    def _process_noise(self, filters: JointState) -> FloatArray:
        """Return the spectral density of each bearing's acceleration, rad^2/s^3."""
        density = self._densities(filters.manoeuvres.level)
        if self._constant_process_noise:
            return density
        held = _HELD_SHARE * self.configuration.steady_process_noise_density
        density = np.where(filters.manoeuvres.held, held, density)
        rates = self.targets(filters).mean[..., 1]
        passing = np.minimum(passing_process_noise(rates), self.configuration.process_noise_density)
        return np.maximum(density, passing)

    @property
    def _constant_process_noise(self) -> bool:
        configuration = self.configuration
        return configuration.steady_process_noise_density >= configuration.process_noise_density

    def _densities(self, level: NDArray[np.int_]) -> FloatArray:
        """Return the spectral densities of levels of process noise, rad^2/s^3."""
        steady = self.configuration.steady_process_noise_density
        share = level / HIGHEST_LEVEL
        return steady ** (1.0 - share) * self.configuration.process_noise_density**share


def _rows(n_targets: int) -> NDArray[np.int_]:
    """Return where angle and rate of each target stand in the state, shape (n_targets, 2)."""
    return np.stack([np.arange(n_targets), n_targets + np.arange(n_targets)], axis=-1)


def _equivalent_measurement(
    before: KalmanState, after: KalmanState, age: float
) -> BearingMeasurement:
    """Return the measurement of each target by itself that would have changed it as the block did.

    With the variances p and p' of an angle before and after, its variance is p p' / (p - p') and
    its innovation the change of the angle times p / (p - p'); NaN where the block told nothing.
    """
    old_angle, old_variance = _angle_at(before, age)
    new_angle, new_variance = _angle_at(after, age)
    gained = old_variance - new_variance
    gained = np.where(gained > _LEAST_GAIN * old_variance, gained, np.nan)
    innovation = (new_angle - old_angle) * old_variance / gained
    variance = old_variance * new_variance / gained
    return BearingMeasurement(old_angle + innovation, innovation, variance, age)


def _angle_at(targets: KalmanState, age: float) -> tuple[FloatArray, FloatArray]:
    """Return the angles some time before and their variances, shape (..., n_targets)."""
    direction = np.array([1.0, -age])
    return targets.mean @ direction, targets.covariance @ direction @ direction
