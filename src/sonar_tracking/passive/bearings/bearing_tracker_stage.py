"""Signal subspaces -> bearing tracks, without data association.

Either each target has its own Kalman filter, with a measurement that starts from its own predicted
steering vector (Ryu, Park, Choi 2003, eq. 6; Hwang et al. 2005, eqs. 18-21), so that every target
knows which measurement is its own; or one filter holds all targets and takes the likelihood of all
their angles at once (:mod:`sonar_tracking.passive.bearings.bearing_method_registry`). The filters
run unbounded in angle; what is reported is folded into the half circle a line array can tell apart,
which changes nothing but the names of angles: a line array cannot distinguish theta from
pi - theta.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_filters import BearingFilters, FilterUpdate
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_start import BearingStart
from sonar_tracking.passive.bearings.bearing_track_list import (
    BearingTrackRows,
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
    subspace_methods_of_covariance,
)
from sonar_tracking.passive.bearings.estimate_checks import check_estimates
from sonar_tracking.passive.bearings.track_existence import (
    ENDED,
    Evidence,
    existence_evidence,
    no_evidence,
)
from sonar_tracking.passive.directions.sources_at_angles import (
    estimated_sources,
    signal_to_noise_ratios,
)
from sonar_tracking.passive.sources.weak_source_counting import WeakSourceCounter
from sonar_tracking.passive.subspaces.rehearsal import rehearsed_estimates
from sonar_tracking.passive.subspaces.subspace_method_registry import SUBSPACE_METHODS
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IndexArray
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

    def keep(self, filters: BearingFilters[Any], rows: IndexArray) -> _TrackerState:
        """Return the state with some of the tracks only."""
        ids = tuple(self.ids[row] for row in rows)
        kept = filters.keep(self.filters, rows)
        return replace(self, ids=ids, filters=kept, existence=self.existence[rows])


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
        self._ends_tracks = configuration.ends_tracks
        self._needs_covariance = configuration.needs_covariance
        self._filters: BearingFilters[Any] = configuration.entry.make(configuration)
        self._next_id = configuration.first_id
        self._state: _TrackerState | None = None

    def warm_up(self) -> None:
        """Let a stage like this one track in made-up data: its first use of much is slow."""
        angles = np.deg2rad(self.configuration.initial_bearings_deg or (-20.0, 10.0))
        twin = BearingTrackerStage(self.configuration)
        with suppress(InputError):
            for second in range(3):
                twin.update(rehearsed_estimates(angles, "covariance", second))

    def reset(self) -> None:
        """Forget all tracks; identifiers go on."""
        self._state = None

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        self._next_id = max(self._next_id, first_id)
        if self._state is not None:
            start = replace(self._state.start, next_id=self._next_id)
            self._state = replace(self._state, start=start)

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
        try:
            return self._update(estimates)
        except np.linalg.LinAlgError as error:
            raise InputError(
                f"No bearings can be computed from the subspaces and covariance ({error})."
            ) from error

    def _update(self, estimates: SubspaceEstimates) -> TrackerUpdate:
        state = self._predict(estimates)
        sources = self._estimate_sources(estimates, state)
        updated = self._measure_and_update(estimates, state, sources)
        state = replace(state, filters=updated.filters)
        targets = self._filters.targets(state.filters)
        state, evidence = self._judge_existence(estimates, state, targets)
        rows = running_rows(
            state.ids,
            targets,
            updated.measurement,
            signal_to_noise_ratios(estimates, sources, targets.mean.shape[:-1]),
            self._status(state, evidence, updated.measurement),
            state.existence if self._automatic else None,
        )
        state, n_seen = self._end_tracks(state, evidence)
        if self._automatic:
            state, new_rows = self._start_tracks(estimates, state, n_seen)
            rows = rows.append(new_rows)
        self._state = state
        self._next_id = max(self._next_id, state.start.next_id)
        # An estimate that only carries the end of the data is empty by nature.
        empty = estimates.next_stamp == END_OF_DATA and estimates.basis.shape[-3] == 0
        return TrackerUpdate(bearing_tracks(estimates, rows), () if empty else updated.notices)

    @property
    def _automatic(self) -> bool:
        return self.configuration.start == "automatic"

    def _check_method(self, estimates: SubspaceEstimates) -> None:
        configuration = self.configuration
        suitable = SUBSPACE_METHODS.names_with("of_covariance")
        if self._needs_covariance and estimates.method not in suitable:
            names = subspace_methods_of_covariance()
            raise InputError(
                f"method {configuration.method} needs estimates of method {names}, but these are "
                f"of method {estimates.method}; set method = {names} in the subspace estimator."
            )

    def _predict(self, estimates: SubspaceEstimates) -> _TrackerState:
        """Move all tracks to the stamp of the estimate; at the first one there are the given."""
        state = self._state
        if state is None:
            return self._begin(estimates)
        interval = seconds(estimates.stamp - state.stamp)
        if interval <= 0.0:
            raise InputError(
                f"The estimate is {-interval:g} s earlier than the one before or repeats it; "
                "estimates must follow each other in time."
            )
        filters = self._filters.predict(state.filters, interval)
        return replace(state, stamp=estimates.stamp, filters=filters)

    def _begin(self, estimates: SubspaceEstimates) -> _TrackerState:
        """Return the state at the first estimate: the given bearings, or none."""
        if self._automatic:
            if estimates.basis.ndim > 3:
                raise InputError(
                    "start = automatic cannot be used on a batch of runs; give the bearings."
                )
            targets = KalmanState(np.empty((0, 2)), np.empty((0, 2, 2)))
        else:
            targets = self._given_targets(estimates)
        n_targets = targets.mean.shape[-2]
        first_new = self._next_id + n_targets
        start = BearingStart(
            process_noise=self.configuration.process_noise_density,
            maximum_rate=float(np.deg2rad(self.configuration.maximum_rate_deg)),
            next_id=first_new,
            follows_count=self._needs_covariance,
            counter=WeakSourceCounter(counted_together=self.configuration.covariances_counted),
        )
        return _TrackerState(
            stamp=estimates.stamp,
            ids=tuple(range(self._next_id, first_new)),
            filters=self._filters.start(targets),
            start=start,
            existence=np.full(n_targets, np.nan),
        )

    def _given_targets(self, estimates: SubspaceEstimates) -> KalmanState:
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
        return KalmanState(
            mean=np.broadcast_to(state, shape),
            covariance=np.broadcast_to(np.diag(variances), (*shape, 2)),
        )

    def _estimate_sources(
        self, estimates: SubspaceEstimates, state: _TrackerState
    ) -> ComplexArray | None:
        """Return the covariance of the sources at the predictions; None = not known."""
        if not state.ids:
            return None
        mean = self._filters.targets(state.filters).mean
        return estimated_sources(estimates, mean[..., 0], mean[..., 1])

    def _measure_and_update(
        self, estimates: SubspaceEstimates, state: _TrackerState, sources: ComplexArray | None
    ) -> FilterUpdate:
        """Measure every track and update its filter; the first estimate only tells the time."""
        if self._state is None or not state.ids:
            return FilterUpdate(state.filters, None)
        return self._filters.update(state.filters, estimates, sources)

    def _judge_existence(
        self, estimates: SubspaceEstimates, state: _TrackerState, targets: KalmanState
    ) -> tuple[_TrackerState, Evidence]:
        """Let the estimate tell which tracks have a source."""
        if not self._automatic or self._state is None:
            return state, no_evidence(len(state.ids))
        interval = seconds(estimates.stamp - self._state.stamp)
        angles, rates = targets.mean[..., 0], targets.mean[..., 1]
        evidence = existence_evidence(estimates, angles, rates, interval)
        existence = evidence.update(state.existence, interval, self.configuration.silence_time)
        return replace(state, existence=existence), evidence

    def _status(
        self,
        state: _TrackerState,
        evidence: Evidence,
        measurement: BearingMeasurement | None,
    ) -> tuple[TrackStatus, ...]:
        """Return the status of each running track; TERMINATED is reported once."""
        coasted = np.full(len(state.ids), measurement is None and self._state is not None)
        if not self._ends_tracks:
            return tuple(np.where(coasted, TrackStatus.COASTED, TrackStatus.CONFIRMED).tolist())
        status = np.where(coasted | evidence.unseen, TrackStatus.COASTED, TrackStatus.CONFIRMED)
        status[state.existence < ENDED] = TrackStatus.TERMINATED
        return tuple(status.tolist())

    def _end_tracks(
        self, state: _TrackerState, evidence: Evidence
    ) -> tuple[_TrackerState, int | None]:
        """Drop ended tracks; return how many of the others have a source, None = all."""
        if not self._ends_tracks:
            return state, None
        rows = np.flatnonzero(state.existence >= ENDED)
        n_seen = int(np.count_nonzero(~evidence.unseen[rows]))
        return state.keep(self._filters, rows), n_seen

    def _start_tracks(
        self, estimates: SubspaceEstimates, state: _TrackerState, n_seen: int | None
    ) -> tuple[_TrackerState, BearingTrackRows]:
        """Let the automatic start see the estimate; return its rows too."""
        angles = self._filters.targets(state.filters).mean[..., 0]
        folded, _ = folded_angles(angles, estimates.element_positions)
        start, started = state.start.update(estimates, folded, n_seen)
        new = started_rows(started)
        grown = replace(
            state,
            start=start,
            ids=state.ids + new.ids,
            filters=self._filters.extend(state.filters, new.filters),
            existence=np.concatenate([state.existence, new.existence_probability]),
        )
        return grown, new.append(tentative_rows(start.tentative, estimates.stamp))
