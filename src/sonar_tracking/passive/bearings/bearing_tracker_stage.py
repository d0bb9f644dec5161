"""Signal subspaces -> bearing tracks, without data association.

Either each target has its own Kalman filter, with a measurement that starts from its own predicted
steering vector (Ryu, Park, Choi 2003, eq. 6; Hwang et al. 2005, eqs. 18-21), so that every target
knows which measurement is its own; or one filter holds all targets and takes the likelihood of all
their angles at once. The filters run unbounded in angle; what is reported is folded into the half
circle a line array can tell apart, which changes nothing but the names of angles: a line array
cannot distinguish theta from pi - theta.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_filters import BearingFilters
from sonar_tracking.passive.bearings.bearing_measurement import (
    BearingMeasurement,
    estimated_sources,
    signal_to_noise_ratios,
)
from sonar_tracking.passive.bearings.bearing_start import BearingStart
from sonar_tracking.passive.bearings.bearing_track_list import (
    TrackRows,
    bearing_tracks,
    folded_angles,
    running_rows,
    started_rows,
    tentative_rows,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    SQUARE_DEGREE,
    BearingTrackerConfiguration,
    check_configuration,
)
from sonar_tracking.passive.bearings.independent_filters import IndependentFilters
from sonar_tracking.passive.bearings.joint_map_filters import JointFilters
from sonar_tracking.passive.bearings.track_existence import (
    ENDED,
    Evidence,
    existence_evidence,
    no_evidence,
)
from sonar_tracking.passive.directions.signal_subspace import noise_factor
from sonar_tracking.passive.sources.weak_source_counting import RecentCovariances
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates, TrackStatus
from sonar_tracking.records.time import END_OF_DATA, seconds

__all__ = ["BearingTrackerConfiguration", "BearingTrackerStage", "TrackerUpdate"]


@dataclass(frozen=True)
class TrackerUpdate:
    """What one subspace estimate gave.

    Attributes
    ----------
    tracks : BearingTracks
        The complete picture at the stamp of the estimate.
    notices : tuple of Notice
        What a user should know about the estimate.
    """

    tracks: BearingTracks
    notices: tuple[Notice, ...]


@dataclass(frozen=True)
class _TrackerState:
    """Everything the tracker remembers between estimates."""

    stamp: int
    ids: tuple[int, ...]
    filters: KalmanState
    start: BearingStart
    existence: FloatArray

    def kept(self, filters: BearingFilters[Any], rows: NDArray[np.intp]) -> _TrackerState:
        """Return the state with some of the tracks only."""
        ids = tuple(self.ids[row] for row in rows)
        left = filters.kept(self.filters, rows)
        return replace(self, ids=ids, filters=left, existence=self.existence[rows])


class BearingTrackerStage:
    """Tracks the bearings of several targets.

    Parameters
    ----------
    configuration : BearingTrackerConfiguration
        Parameters.

    Raises
    ------
    ConfigurationError
        If the parameters do not fit together.
    """

    def __init__(self, configuration: BearingTrackerConfiguration) -> None:
        check_configuration(configuration)
        self.configuration = configuration
        joint = configuration.method == "joint_map"
        self._filters: BearingFilters[Any] = (JointFilters if joint else IndependentFilters)(
            configuration
        )
        self._next_id = configuration.first_id
        self._state: _TrackerState | None = None

    def reset(self) -> None:
        """Forget all tracks; identifiers go on."""
        self._state = None

    def update(self, estimates: SubspaceEstimates) -> TrackerUpdate:
        """Take the subspaces of one sample time.

        With ``start = given`` the first estimate only tells the instant of the given bearings;
        measurements are taken from the next one on.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Later than the one before.

        Returns
        -------
        TrackerUpdate
            All tracks at the stamp of the estimate.

        Raises
        ------
        InputError
            If the estimate cannot be used; the stage is then as before.
        """
        check_estimates(estimates)
        self._check_method(estimates)
        measurement: BearingMeasurement | None = None
        notices: tuple[Notice, ...] = ()
        if self._state is None and self.configuration.start == "given":
            state = self._given_state(estimates)
            sources = self._sources(estimates, state)
        else:
            state = self._predicted(estimates)
            sources = self._sources(estimates, state)
            if state.ids:
                updated = self._filters.updated(state.filters, estimates, sources)
                measurement, notices = updated.measurement, updated.notices
                state = replace(state, filters=updated.filters)
        targets = self._filters.targets(state.filters)
        automatic = self.configuration.start == "automatic"
        state, evidence = self._with_existence(state, estimates, targets)
        rows = running_rows(
            state.ids,
            targets,
            measurement,
            signal_to_noise_ratios(estimates, sources, targets.mean.shape[:-1]),
            self._status(state, evidence, measurement),
            state.existence if automatic else None,
        )
        if automatic:
            state, new_rows = self._with_started(state, estimates, evidence)
            rows = rows.appended(new_rows)
        self._state = state
        self._next_id = max(self._next_id, state.start.next_id)
        if estimates.next_stamp == END_OF_DATA and estimates.basis.shape[-3] == 0:
            notices = ()  # An estimate that only carries the end of the data is empty by nature.
        return TrackerUpdate(bearing_tracks(estimates, rows), notices)

    def _check_method(self, estimates: SubspaceEstimates) -> None:
        configuration = self.configuration
        if configuration.needs_covariance and estimates.method != "covariance":
            raise InputError(
                f"method {configuration.method} needs estimates of method covariance, but these "
                f"are of method {estimates.method}; set method = covariance in the subspace "
                "estimator."
            )

    def _given_state(self, estimates: SubspaceEstimates) -> _TrackerState:
        configuration = self.configuration
        angles = np.deg2rad(configuration.initial_bearings_deg)
        n_targets = len(angles)
        if n_targets >= len(estimates.element_positions):
            raise InputError(
                f"initial_bearings_deg has {n_targets} bearings but the array has only "
                f"{len(estimates.element_positions)} elements; give fewer bearings than elements."
            )
        state = np.stack([angles, np.deg2rad(configuration.initial_rates_deg)], axis=-1)
        variances = SQUARE_DEGREE * np.array(
            [configuration.initial_angle_variance_deg2, configuration.initial_rate_variance_deg2]
        )
        shape = (*estimates.basis.shape[:-3], n_targets, 2)
        targets = KalmanState(
            mean=np.broadcast_to(state, shape),
            covariance=np.broadcast_to(np.diag(variances), (*shape, 2)),
        )
        filters = self._filters.started(targets)
        ids = tuple(range(self._next_id, self._next_id + n_targets))
        start = self._new_start(n_targets)
        return _TrackerState(estimates.stamp, ids, filters, start, np.full(n_targets, np.nan))

    def _new_start(self, n_given: int) -> BearingStart:
        return BearingStart(
            process_noise=self.configuration.process_noise_density,
            maximum_rate=float(np.deg2rad(self.configuration.maximum_rate_deg)),
            next_id=self._next_id + n_given,
            follows_count=self.configuration.needs_covariance,
            recent=RecentCovariances(counted_together=self.configuration.covariances_counted),
        )

    def _predicted(self, estimates: SubspaceEstimates) -> _TrackerState:
        state = self._state
        if state is None:
            if estimates.basis.ndim > 3:
                raise InputError(
                    "start = automatic cannot be used on a batch of runs; give the bearings."
                )
            none = self._filters.started(KalmanState(np.empty((0, 2)), np.empty((0, 2, 2))))
            return _TrackerState(estimates.stamp, (), none, self._new_start(0), np.empty(0))
        interval = seconds(estimates.stamp - state.stamp)
        if interval <= 0.0:
            raise InputError(
                f"The estimate is {-interval:g} s earlier than the one before or repeats it; "
                "estimates must follow each other in time."
            )
        filters = self._filters.predicted(state.filters, interval)
        return replace(state, stamp=estimates.stamp, filters=filters)

    def _sources(self, estimates: SubspaceEstimates, state: _TrackerState) -> ComplexArray | None:
        if not state.ids:
            return None
        mean = self._filters.targets(state.filters).mean
        return estimated_sources(estimates, mean[..., 0], mean[..., 1])

    def _with_existence(
        self, state: _TrackerState, estimates: SubspaceEstimates, targets: KalmanState
    ) -> tuple[_TrackerState, Evidence]:
        """Let the estimate tell which tracks have a source."""
        if self.configuration.start == "given" or self._state is None:
            return state, no_evidence(len(state.ids))
        interval = seconds(estimates.stamp - self._state.stamp)
        angles, rates = targets.mean[..., 0], targets.mean[..., 1]
        evidence = existence_evidence(estimates, angles, rates, interval)
        silence = self.configuration.silence_time
        return replace(
            state, existence=evidence.updated(state.existence, interval, silence)
        ), evidence

    def _status(
        self,
        state: _TrackerState,
        evidence: Evidence,
        measurement: BearingMeasurement | None,
    ) -> tuple[TrackStatus, ...]:
        """Return the status of each running track; TERMINATED is told once."""
        coasted = np.full(len(state.ids), measurement is None and self._state is not None)
        if not self.configuration.ends_tracks:
            return tuple(np.where(coasted, TrackStatus.COASTED, TrackStatus.CONFIRMED).tolist())
        status = np.where(coasted | evidence.unseen, TrackStatus.COASTED, TrackStatus.CONFIRMED)
        status[state.existence < ENDED] = TrackStatus.TERMINATED
        return tuple(status.tolist())

    def _with_started(
        self, state: _TrackerState, estimates: SubspaceEstimates, evidence: Evidence
    ) -> tuple[_TrackerState, TrackRows]:
        """Drop ended tracks and let the automatic start see the estimate; return its rows too."""
        n_seen = None
        if self.configuration.ends_tracks:
            rows = np.flatnonzero(state.existence >= ENDED)
            n_seen = int(np.count_nonzero(~evidence.unseen[rows]))
            state = state.kept(self._filters, rows)
        angles = self._filters.targets(state.filters).mean[..., 0]
        folded, _ = folded_angles(angles, estimates.element_positions)
        start, started = state.start.update(estimates, folded, n_seen)
        new = started_rows(started)
        filters = self._filters.extended(state.filters, new.filters)
        grown = replace(
            state,
            start=start,
            ids=state.ids + new.ids,
            filters=filters,
            existence=np.concatenate([state.existence, new.existence_probability]),
        )
        return grown, new.appended(tentative_rows(start.tentative, estimates.stamp))


def check_estimates(estimates: SubspaceEstimates) -> None:
    """Reject estimates whose parts do not fit together, are not finite or no covariance of noise.

    Raises
    ------
    InputError
        With one sentence for the first thing that is wrong.
    """
    shape, n_elements = estimates.basis.shape, len(estimates.element_positions)
    if estimates.basis.ndim < 3 or shape[-2] != n_elements:
        raise InputError(
            f"The bases have shape {shape} but the array has {n_elements} elements; they must "
            "be (n_subspaces, n_elements, n_columns)."
        )
    if shape[-3] != len(estimates.time_offsets):
        raise InputError(
            f"There are {shape[-3]} subspaces but {len(estimates.time_offsets)} time offsets."
        )
    if shape[-3] > 0 and not 0 < shape[-1] < n_elements:
        raise InputError(
            f"The subspaces have {shape[-1]} columns; an array of {n_elements} elements needs "
            f"between 1 and {n_elements - 1}."
        )
    if not np.isfinite(estimates.basis).all():
        raise InputError("A subspace holds values that are not finite numbers.")
    if estimates.covariance is not None and not np.isfinite(estimates.covariance).all():
        raise InputError("The covariance holds values that are not finite numbers.")
    noise = estimates.noise_covariance
    if noise is not None:
        if noise.shape != (n_elements, n_elements) or not np.isfinite(noise).all():
            raise InputError(
                f"The noise covariance has shape {noise.shape} or values that are not finite; it "
                f"must be {n_elements} by {n_elements} finite numbers."
            )
        noise_factor(noise)
