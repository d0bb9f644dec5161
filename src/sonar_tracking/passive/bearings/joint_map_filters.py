"""One filter over the angles and rates of all targets: joint maximum a posteriori (MAP) tracking.

The state of n targets is [n angles, n rates]. A block measures the angles at its middle, half a
block before the sample time when it ends there, at the sample time when it is centred on it. How
much each bearing turns is found out by modes of its own, which also refine it where the array tells
it from all others (:mod:`sonar_tracking.passive.bearings.motion_modes`); where it does not, there
are two accounts of what happens (:mod:`sonar_tracking.passive.bearings.encounters`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.geometry import beamwidth, wavenumber
from sonar_tracking.passive.bearings.bearing_filters import FilterUpdate
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.covariance_subspace import covariance_subspace
from sonar_tracking.passive.bearings.encounters import Encounter, no_encounter
from sonar_tracking.passive.bearings.faint_measurement import Fit, fit_with_faint
from sonar_tracking.passive.bearings.joint_map_update import (
    JointUpdate,
    predict_jointly,
    update_jointly,
)
from sonar_tracking.passive.bearings.joint_states import (
    each_target,
    extended,
    target_rows,
    uncorrelated,
    with_marginals,
)
from sonar_tracking.passive.bearings.motion_modes import (
    N_MODES,
    MotionModes,
    mode_densities,
    passing_process_noise,
    turning_back_process_noise,
    undecided,
)
from sonar_tracking.passive.directions.sources_at_angles import unresolved
from sonar_tracking.passive.directions.weighted_subspace_fit import (
    SubspaceFit,
    weighted_subspace_fit,
)
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray, IndexArray
from sonar_tracking.records.bearings import SubspaceEstimates

_LEAST_GAIN = 1e-9
"""Share of its variance that an angle must lose for the block to count as a measurement of it."""

_MOST_OF_A_TURN = 0.1
"""Of the process noise of a turn, for turning back: those that come near each other fast pass."""


@dataclass(frozen=True)
class JointMapState(KalmanState):
    """Angles and rates of all targets.

    Attributes
    ----------
    mean : ndarray, shape (..., 2 n)
        rad, rad/s; while an encounter is open by the account that bearings pass.
    covariance : ndarray, shape (..., 2 n, 2 n)
        rad^2, rad^2/s, rad^2/s^2.
    modes : MotionModes
        How much each bearing turns; none where it is known.
    close : ndarray of bool, shape (..., n)
        Whether the array did not resolve the bearing from another at the last update.
    turning_back : ndarray, shape (..., n)
        Process noise of the bearing by the account that it turns back, rad^2/s^3.
    encounter : Encounter
        The account that bearings turn back.
    """

    modes: MotionModes
    close: BoolArray
    turning_back: FloatArray
    encounter: Encounter


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
        return self._of(uncorrelated(targets), undecided(targets, self._n_modes))

    def extend(self, filters: JointMapState, targets: KalmanState) -> JointMapState:
        """Return the filter with more targets, uncorrelated with those there are."""
        modes = filters.modes.extend(undecided(targets, self._n_modes))
        more = uncorrelated(targets)
        encounter = filters.encounter
        joint = extended(filters, more)
        back = extended(KalmanState(encounter.mean, encounter.covariance), more)
        new = self._of(joint, modes)
        n_old = filters.close.shape[-1]
        close, turning_back = new.close.copy(), new.turning_back.copy()
        close[..., :n_old], turning_back[..., :n_old] = filters.close, filters.turning_back
        return replace(
            new,
            close=close,
            turning_back=turning_back,
            encounter=encounter.with_account(back, encounter.log_odds),
        )

    def keep(self, filters: JointMapState, rows: IndexArray) -> JointMapState:
        """Return the filter of some of the targets, by their rows, with their correlations.

        Parameters
        ----------
        filters : JointMapState
            Of all targets.
        rows : ndarray of int, shape (n_kept,)
            Targets to keep.
        """
        entries = target_rows(filters.mean.shape[-1] // 2)[rows].T.reshape(-1)
        encounter = filters.encounter
        return JointMapState(
            filters.mean[..., entries],
            filters.covariance[..., entries[:, None], entries],
            filters.modes.keep(rows),
            filters.close[..., rows],
            filters.turning_back[..., rows],
            replace(
                encounter,
                mean=encounter.mean[..., entries],
                covariance=encounter.covariance[..., entries[:, None], entries],
            ),
        )

    def predict(self, filters: JointMapState, interval: float) -> JointMapState:
        """Return the filter after an interval in s."""
        if not self._n_modes:
            density = self.configuration.process_noise_density
            state = predict_jointly(filters, interval, density)
            return replace(filters, mean=state.mean, covariance=state.covariance)
        modes, noise = filters.modes.predict(interval, self._densities(filters))
        steady = np.where(filters.close, self._steady_noise(filters), noise)
        state = predict_jointly(filters, interval, steady)
        encounter = filters.encounter
        if encounter.open.any():
            turning = np.where(filters.close, np.maximum(filters.turning_back, noise), noise)
            back = KalmanState(encounter.mean, encounter.covariance)
            back = predict_jointly(back, interval, turning)
        else:
            back = state
        return replace(
            filters,
            mean=state.mean,
            covariance=state.covariance,
            modes=modes,
            encounter=encounter.with_account(back, encounter.log_odds),
        )

    def update(
        self,
        filters: JointMapState,
        estimates: SubspaceEstimates,
        sources: ComplexArray | None,
        excess: FloatArray | None = None,
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
        excess : ndarray, shape (..., n_targets), optional
            Power of each faint source in its beam, over that of the noise, pure numbers; NaN = not
            faint.
        """
        subspace, notices = covariance_subspace(self.configuration, estimates)
        fit: Fit | None = None
        if subspace is not None:
            fit = partial(
                weighted_subspace_fit,
                subspace,
                estimates.covariance_snapshots,
                estimates.element_positions,
                wavenumber=wavenumber(estimates.center_frequency, estimates.sound_speed),
            )
        if excess is not None and estimates.covariance is not None:
            fit, notices = (
                fit_with_faint(fit, subspace, estimates, estimates.covariance, excess),
                (),
            )
        if fit is None:
            return FilterUpdate(filters, None, notices)
        age = -estimates.covariance_time_offset
        corrected = update_jointly(filters, age, fit)
        before = self.targets(filters)
        state = replace(filters, mean=corrected.state.mean, covariance=corrected.state.covariance)
        if self._n_modes:
            state = self._update_turning_back(state, corrected, age, fit)
        measurement = _equivalent_measurement(before, self.targets(state), age)
        if self._n_modes:
            state = self._weigh(state, measurement, estimates)
        return FilterUpdate(state, measurement, notices, subspace)

    def coasted(
        self, filters: JointMapState, predicted: JointMapState, rows: BoolArray
    ) -> JointMapState:
        """Return the filter with some targets, by a mask, shape (..., n), as predicted."""
        joint = with_marginals(filters, each_target(filters), each_target(predicted), rows)
        modes = filters.modes
        if self._n_modes:
            modes = modes.instead(rows, predicted.modes)
        return replace(filters, mean=joint.mean, covariance=joint.covariance, modes=modes)

    def targets(self, filters: JointMapState) -> KalmanState:
        """Return angle and rate of each target."""
        return each_target(filters.encounter.told(filters))

    @cached_property
    def _n_modes(self) -> int:
        """Modes of each target, 0 if its process noise is known."""
        configuration = self.configuration
        known = configuration.steady_process_noise_density >= configuration.process_noise_density
        return 0 if known else N_MODES

    @cached_property
    def _mode_densities(self) -> FloatArray:
        configuration = self.configuration
        return mode_densities(
            configuration.steady_process_noise_density, configuration.process_noise_density
        )

    def _of(self, joint: KalmanState, modes: MotionModes) -> JointMapState:
        """Return the filter of a joint state, without an encounter."""
        shape = (*joint.mean.shape[:-1], joint.mean.shape[-1] // 2)
        return JointMapState(
            joint.mean,
            joint.covariance,
            modes,
            np.zeros(shape, dtype=bool),
            np.zeros(shape),
            no_encounter(joint),
        )

    def _steady_noise(self, filters: JointMapState) -> FloatArray:
        """Return the least spectral density of each bearing's acceleration, rad^2/s^3."""
        configuration = self.configuration
        passing = passing_process_noise(self.targets(filters).mean[..., 1])
        return np.clip(
            passing,
            configuration.steady_process_noise_density,
            configuration.process_noise_density,
        )

    def _densities(self, filters: JointMapState) -> FloatArray:
        """Return the spectral density of the acceleration in each mode, rad^2/s^3."""
        return np.maximum(self._mode_densities, self._steady_noise(filters)[..., None])

    def _update_turning_back(
        self,
        state: JointMapState,
        passing: JointUpdate,
        age: float,
        fit: Callable[[FloatArray], SubspaceFit],
    ) -> JointMapState:
        """Return the filter with the account of turning back after the block."""
        encounter = state.encounter
        if not encounter.open.any():
            return replace(state, encounter=encounter.with_account(state, encounter.log_odds))
        back = update_jointly(KalmanState(encounter.mean, encounter.covariance), age, fit)
        told = np.where(encounter.open, back.log_evidence - passing.log_evidence, 0.0)
        encounter = encounter.with_account(back.state, encounter.log_odds + told)
        return replace(state, encounter=encounter)

    def _weigh(
        self, state: JointMapState, measurement: BearingMeasurement, estimates: SubspaceEstimates
    ) -> JointMapState:
        """Return the filter after its modes have seen what the block has told of each target."""
        targets = self.targets(state)
        middle = targets.mean[..., 0] - measurement.age * targets.mean[..., 1]
        pairs = unresolved(middle, middle, estimates) & ~np.eye(middle.shape[-1], dtype=bool)
        close = np.asarray(pairs.any(axis=-1))
        told = ~close & np.isfinite(measurement.variance) & ~state.encounter.open[..., None]
        modes = state.modes.update(measurement.angle, measurement.variance, measurement.age, told)
        modes = modes.restarted(targets, ~told)
        if told.any():
            joint = with_marginals(state, targets, modes.combined(), told)
            state = replace(state, mean=joint.mean, covariance=joint.covariance)
        encounter, passing = state.encounter.settled(state, np.asarray(close.any(axis=-1)))
        number = wavenumber(estimates.center_frequency, estimates.sound_speed)
        separation = 0.5 * beamwidth(estimates.element_positions, number)
        turning_back = turning_back_process_noise(targets.mean[..., 1], pairs, separation)
        most = _MOST_OF_A_TURN * self.configuration.process_noise_density
        return JointMapState(
            passing.mean,
            passing.covariance,
            modes,
            close,
            np.minimum(turning_back, most),
            encounter,
        )


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
