"""One filter over the angles and rates of all targets: joint maximum a posteriori (MAP) tracking.

The state of n targets is [n angles, n rates]. A block measures the angles at its middle, half a
block before the sample time when it ends there, at the sample time when it is centred on it. Each
bearing has its level of process noise, from that of steady motion to the full one of a turn, and
never less than passing at its rate takes
(:mod:`sonar_tracking.passive.bearings.manoeuvre_detection`). When a turn is found out the update is
done again, with what the turn has added since it began.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.bearings.bearing_filters import FilterUpdate
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.covariance_subspace import covariance_subspace
from sonar_tracking.passive.bearings.joint_map_update import (
    joint_process_noise,
    predict_jointly,
    update_jointly,
)
from sonar_tracking.passive.bearings.manoeuvre_detection import (
    HIGHEST_LEVEL,
    MEMORY,
    Manoeuvres,
    passing_process_noise,
    steady,
)
from sonar_tracking.passive.directions.sources_at_angles import unresolved
from sonar_tracking.passive.directions.weighted_subspace_fit import weighted_subspace_fit
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray, IndexArray, IntArray
from sonar_tracking.records.bearings import SubspaceEstimates

_LEAST_GAIN = 1e-9
"""Share of its variance that an angle must lose for the block to count as a measurement of it."""

_HELD_SHARE = 0.1
"""Of the steady process noise, while the array does not resolve a bearing from another."""


@dataclass(frozen=True)
class JointMapState(KalmanState):
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
class JointMapFilters:
    """Filter of targets that share a covariance.

    Attributes
    ----------
    configuration : BearingTrackerConfiguration
        Parameters.
    """

    configuration: BearingTrackerConfiguration

    def start(self, targets: KalmanState) -> JointMapState:
        """Return the filter of uncorrelated targets."""
        batch = targets.mean.shape[:-2]
        nobody = JointMapState(np.empty((*batch, 0)), np.empty((*batch, 0, 0)), steady((*batch, 0)))
        return self.extend(nobody, targets)

    def extend(self, filters: JointMapState, targets: KalmanState) -> JointMapState:
        """Return the filter with more targets, uncorrelated with those there are."""
        n_old = filters.mean.shape[-1] // 2
        rows = _rows(n_old + targets.mean.shape[-2])
        mean = np.empty((*targets.mean.shape[:-2], rows.size))
        covariance = np.zeros((*mean.shape, rows.size))
        old, new = rows[:n_old].T.reshape(-1), rows[n_old:]
        mean[..., old], mean[..., new] = filters.mean, targets.mean
        covariance[..., old[:, None], old] = filters.covariance
        covariance[..., new[:, :, None], new[:, None, :]] = targets.covariance
        manoeuvres = filters.manoeuvres.extend(len(new))
        return JointMapState(mean, covariance, manoeuvres, filters.interval)

    def keep(self, filters: JointMapState, rows: IndexArray) -> JointMapState:
        """Return the filter of some of the targets, by their rows, with their correlations.

        Parameters
        ----------
        filters : JointMapState
            Of all targets.
        rows : ndarray of int, shape (n_kept,)
            Targets to keep.
        """
        entries = _rows(filters.mean.shape[-1] // 2)[rows].T.reshape(-1)
        return JointMapState(
            filters.mean[..., entries],
            filters.covariance[..., entries[:, None], entries],
            filters.manoeuvres.keep(rows),
            filters.interval,
        )

    def predict(self, filters: JointMapState, interval: float) -> JointMapState:
        """Return the filter after an interval in s."""
        state = predict_jointly(filters, interval, self._process_noise(filters))
        return replace(
            filters,
            mean=state.mean,
            covariance=state.covariance,
            interval=filters.interval + interval,
        )

    def update(
        self,
        filters: JointMapState,
        estimates: SubspaceEstimates,
        sources: ComplexArray | None,
    ) -> FilterUpdate:
        """Return the filter after the block of an estimate.

        Parameters
        ----------
        filters : JointMapState
            Predicted to the stamp of the estimate.
        estimates : SubspaceEstimates
            What was measured.
        sources : ndarray, shape (..., n_targets, n_targets), complex, or None
            Covariance of the sources, linear power: not used, the likelihood of the block finds
            its own.
        """
        subspace, notices = covariance_subspace(self.configuration, estimates)
        if subspace is None:
            return FilterUpdate(filters, None, notices)
        fit = partial(
            weighted_subspace_fit,
            subspace,
            estimates.covariance_snapshots,
            estimates.element_positions,
            wavenumber=wavenumber(estimates.center_frequency, estimates.sound_speed),
        )
        age = -estimates.covariance_time_offset
        corrected = update_jointly(filters, age, fit)
        manoeuvres = self._judge_manoeuvres(filters, corrected, estimates)
        begun = manoeuvres.level > filters.manoeuvres.level
        if begun.any():
            filters = self._add_turn(filters, begun, manoeuvres.level)
            corrected = update_jointly(filters, age, fit)
        measurement = _equivalent_measurement(self.targets(filters), self.targets(corrected), age)
        state = JointMapState(corrected.mean, corrected.covariance, manoeuvres)
        return FilterUpdate(state, measurement, notices)

    def targets(self, filters: KalmanState) -> KalmanState:
        """Return angle and rate of each target."""
        rows = _rows(filters.mean.shape[-1] // 2)
        return KalmanState(
            mean=filters.mean[..., rows],
            covariance=filters.covariance[..., rows[:, :, None], rows[:, None, :]],
        )

    def _judge_manoeuvres(
        self, before: JointMapState, after: KalmanState, estimates: SubspaceEstimates
    ) -> Manoeuvres:
        """Return which bearings turn, by the first update."""
        configuration = self.configuration
        if configuration.steady_process_noise_density >= configuration.process_noise_density:
            return before.manoeuvres
        targets = self.targets(before)
        age = -estimates.covariance_time_offset
        middle = targets.mean[..., 0] - age * targets.mean[..., 1]
        close = unresolved(middle, middle, estimates) & ~np.eye(middle.shape[-1], dtype=bool)
        resolved = np.asarray(~close.any(axis=-1))
        return before.manoeuvres.update(
            targets, self.targets(after), age, before.interval, resolved
        )

    def _add_turn(self, filters: JointMapState, begun: BoolArray, level: IntArray) -> JointMapState:
        """Return the prediction with what a turn has added to some bearings by now."""
        configuration = self.configuration
        steady = configuration.steady_process_noise_density
        turning = configuration.process_noise_density
        density = np.where(begun, _densities(level, steady, turning), 0.0)
        added = joint_process_noise(begun.shape[-1], MEMORY, density)
        return replace(filters, covariance=filters.covariance + added)

    def _process_noise(self, filters: JointMapState) -> FloatArray:
        """Return the spectral density of each bearing's acceleration, rad^2/s^3."""
        steady = self.configuration.steady_process_noise_density
        turning = self.configuration.process_noise_density
        density = _densities(filters.manoeuvres.level, steady, turning)
        if steady >= turning:
            return density
        density = np.where(filters.manoeuvres.held, _HELD_SHARE * steady, density)
        rates = self.targets(filters).mean[..., 1]
        return np.maximum(density, np.minimum(passing_process_noise(rates), turning))


def _densities(level: IntArray, steady: float, turning: float) -> FloatArray:
    """Return the spectral densities of levels of process noise, rad^2/s^3."""
    share = level / HIGHEST_LEVEL
    return steady ** (1.0 - share) * turning**share


@lru_cache(maxsize=64)
def _rows(n_targets: int) -> IntArray:
    """Return where angle and rate of each target stand in the state, shape (n_targets, 2)."""
    rows = np.stack([np.arange(n_targets), n_targets + np.arange(n_targets)], axis=-1)
    rows.setflags(write=False)
    return rows


def _equivalent_measurement(
    before: KalmanState, after: KalmanState, age: float
) -> BearingMeasurement:
    """Return the measurement of each target by itself that would have changed it as the block did.

    With the variances p and p' of an angle before and after, its variance is p p' / (p - p') and
    its innovation the change of the angle times p / (p - p'); NaN where the block says nothing.
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
