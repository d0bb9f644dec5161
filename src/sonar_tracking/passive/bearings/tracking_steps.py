"""The steps of bearing tracking: running tracks are followed, ended ones dropped, new ones started.

Following is done on arrays and so for several runs at once where these are alike
(:mod:`sonar_tracking.passive.bearings.tracking_together`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_filters import BearingFilters, FilterUpdate
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
)
from sonar_tracking.passive.bearings.followed_tracks import FollowedTracks
from sonar_tracking.passive.bearings.steering_uncertainty import (
    SteeringMisfit,
    SteeringUncertainty,
    steering_misfit,
    tells_of_steering,
)
from sonar_tracking.passive.bearings.track_existence import (
    ENDED,
    Evidence,
    existence_evidence,
    faint_excess,
    no_evidence,
)
from sonar_tracking.passive.bearings.tracker_state import TrackerState, TrackerUpdate
from sonar_tracking.passive.directions.sources_at_angles import (
    estimated_sources,
    signal_to_noise_ratios,
)
from sonar_tracking.passive.sources.weak_source_counting import WeakSourceCounter
from sonar_tracking.passive.track_start.bearing_start import BearingStart
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates, TrackStatus
from sonar_tracking.records.time import END_OF_DATA, seconds


@dataclass(frozen=True)
class TrackingSteps:
    """The steps of bearing tracking, from state to state.

    Attributes
    ----------
    configuration : BearingTrackerConfiguration
        Parameters.
    filters : BearingFilters
        Of all targets.
    """

    configuration: BearingTrackerConfiguration
    filters: BearingFilters[Any]

    @cached_property
    def ends_tracks(self) -> bool:
        """Whether tracks without a source end."""
        return self.configuration.ends_tracks

    @cached_property
    def needs_covariance(self) -> bool:
        """Whether bearings are measured in the block covariance."""
        return self.configuration.needs_covariance

    @cached_property
    def seeks_faint(self) -> bool:
        """Whether sources are sought that no covariance shows by itself."""
        return self.configuration.track_before_detect and self.configuration.entry.holds_faint

    @property
    def automatic(self) -> bool:
        """Whether tracks start by themselves."""
        return self.configuration.start == "automatic"

    def begin(self, estimates: SubspaceEstimates, next_id: int) -> TrackerState:
        """Return the state at the first estimate: the given bearings, or none.

        Parameters
        ----------
        estimates : SubspaceEstimates
            The first one.
        next_id : int
            Identifier of the next track.

        Raises
        ------
        InputError
            If the array has too few elements, or tracks of several runs were to start at once.
        """
        if self.automatic:
            if estimates.basis.ndim > 3:
                raise InputError(
                    "start = automatic cannot be used on a batch of runs; give the bearings."
                )
            targets = KalmanState(np.empty((0, 2)), np.empty((0, 2, 2)))
        else:
            targets = self._given_targets(estimates)
        n_targets = targets.mean.shape[-2]
        first_new = next_id + n_targets
        start = BearingStart(
            process_noise=self.configuration.process_noise_density,
            maximum_rate=float(np.deg2rad(self.configuration.maximum_rate_deg)),
            next_id=first_new,
            follows_count=self.needs_covariance,
            counter=WeakSourceCounter(counted_together=self.configuration.covariances_counted),
        )
        return TrackerState(
            stamp=estimates.stamp,
            ids=tuple(range(next_id, first_new)),
            filters=self.filters.start(targets),
            start=start,
            existence=np.full(n_targets, np.nan),
            excess=np.full(n_targets, np.nan),
        )

    def follow(
        self, estimates: SubspaceEstimates, state: TrackerState, interval: float | None
    ) -> FollowedTracks:
        """Return the running tracks at an estimate.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Of one run, or with a first dimension of several runs that are alike.
        state : TrackerState
            Before it; of several runs, with that dimension.
        interval : float or None
            Since the last estimate, s; None = this is the first one, which only tells the time.
        """
        filters = state.filters
        if interval is not None:
            filters = self.filters.predict(filters, interval)
        predicted = self.filters.targets(filters).mean
        excess = state.excess if np.isfinite(state.excess).any() else None
        sources, updated = None, FilterUpdate(filters, None)
        if predicted.shape[-2]:
            sources = estimated_sources(estimates, predicted[..., 0], predicted[..., 1])
            if interval is not None:
                updated = self.filters.update(filters, estimates, sources, excess)
        existence = state.existence
        evidence = replace(no_evidence(existence.shape), excess=state.excess)
        if self.automatic and interval is not None:
            mean = self.filters.targets(updated.filters).mean
            evidence = existence_evidence(estimates, mean[..., 0], mean[..., 1], interval, excess)
            existence = evidence.update(existence, interval, self.configuration.silence_time)
            evidence = evidence.holding(existence)
            if self.ends_tracks and evidence.unseen.any():
                updated = self._without_unseen(updated, filters, evidence.unseen)
        return FollowedTracks(
            updated.filters,
            self.filters.targets(updated.filters),
            existence,
            updated.measurement,
            signal_to_noise_ratios(estimates, sources, predicted.shape[:-1]),
            evidence,
            updated.notices,
            interval is None,
            self._misfit(estimates, state, updated),
        )

    def _without_unseen(
        self, updated: FilterUpdate, predicted: Any, unseen: BoolArray
    ) -> FilterUpdate:
        """Return an update in which tracks without a source are predicted: noise is no bearing."""
        coasted = self.filters.coasted(updated.filters, predicted, unseen)
        measurement = updated.measurement
        if measurement is not None:
            measurement = measurement.without(unseen)
        return replace(updated, filters=coasted, measurement=measurement)

    def finish(
        self,
        estimates: SubspaceEstimates,
        before: TrackerState,
        followed: FollowedTracks,
        n_weak: int,
    ) -> tuple[TrackerState, TrackerUpdate]:
        """Return the tracks of one run after an estimate: those that go on, end and start.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Of the run.
        before : TrackerState
            Before the estimate.
        followed : FollowedTracks
            Its running tracks.
        n_weak : int
            Sources that the means of its covariances show at least.
        """
        state = replace(
            before,
            stamp=estimates.stamp,
            filters=followed.filters,
            existence=followed.existence,
            excess=followed.evidence.excess,
            ended=(),
        )
        rows = running_rows(
            state.ids,
            followed.targets,
            followed.measurement,
            followed.signal_to_noise_ratio,
            self._status(state, followed),
            state.existence if self.automatic else None,
        )
        n_faint = followed.evidence.n_shown(estimates.covariance_snapshots)
        for each in before.ended:
            rows = rows.append(each)
        state, n_seen = self._end_tracks(state, followed.evidence)
        if self.automatic:
            same = state.ids == before.ids
            mean = (followed.targets if same else self.filters.targets(state.filters)).mean
            state, new_rows = self._start_tracks(estimates, state, mean, n_seen, n_weak, n_faint)
            hidden = {pair.track_id: pair.half_separation() for pair in state.start.pairs}
            rows = rows.without(new_rows.ids).widened(hidden).append(new_rows)
        # An estimate that only carries the end of the data is empty by nature.
        empty = estimates.next_stamp == END_OF_DATA and estimates.basis.shape[-3] == 0
        notices = () if empty else followed.notices
        steering = self._judge_array(estimates, before, followed)
        tracks = steering.widened(bearing_tracks(estimates, rows), estimates)
        state = replace(state, steering=steering)
        return state, TrackerUpdate(tracks, notices + steering.notices(estimates))

    def _misfit(
        self, estimates: SubspaceEstimates, state: TrackerState, updated: FilterUpdate
    ) -> SteeringMisfit | None:
        """Return what the covariance leaves at the bearings after it."""
        # Runs that one stage follows have one array state in common, which is none of theirs.
        of_its_own = state.existence.ndim == estimates.basis.ndim - 2
        if updated.measurement is None or not self.needs_covariance or not of_its_own:
            return None
        mean = self.filters.targets(updated.filters).mean
        telling = tells_of_steering(estimates, mean.shape[-2])
        if not telling or not state.steering.looks_at(len(estimates.element_positions)):
            return None
        angles = mean[..., 0] + mean[..., 1] * estimates.covariance_time_offset
        return steering_misfit(estimates, angles, updated.subspace)

    def _judge_array(
        self, estimates: SubspaceEstimates, before: TrackerState, followed: FollowedTracks
    ) -> SteeringUncertainty:
        """Return what the array differs from its description, by one more covariance."""
        duration = estimates.covariance_snapshots * estimates.sample_period
        if followed.measurement is None or not self.needs_covariance or not duration > 0.0:
            return before.steering
        if estimates.basis.ndim > 3 or not tells_of_steering(estimates, len(before.ids)):
            return before.steering
        share = min(seconds(estimates.stamp - before.stamp) / duration, 1.0)
        return before.steering.update(followed.misfit, share)

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

    def _status(self, state: TrackerState, followed: FollowedTracks) -> tuple[TrackStatus, ...]:
        """Return the status of each running track; TERMINATED is reported once."""
        nothing = followed.measurement is None and not followed.first
        unseen = followed.evidence.unseen.tolist() if self.ends_tracks else [False] * len(state.ids)
        status = [
            TrackStatus.COASTED if nothing or each else TrackStatus.CONFIRMED for each in unseen
        ]
        if self.ends_tracks:
            for row in np.flatnonzero(state.existence < ENDED).tolist():
                status[row] = TrackStatus.TERMINATED
        return tuple(status)

    def _end_tracks(
        self, state: TrackerState, evidence: Evidence
    ) -> tuple[TrackerState, int | None]:
        """Drop ended tracks; return how many of the others a covariance shows, None = all."""
        if not self.ends_tracks:
            return state, None
        going_on = state.existence >= ENDED
        # Faint sources are not among those counted in a covariance.
        n_seen = int(np.count_nonzero(going_on & ~evidence.unseen & ~evidence.faint))
        if going_on.all():
            return state, n_seen
        return state.keep(self.filters, np.flatnonzero(going_on)), n_seen

    def _start_tracks(
        self,
        estimates: SubspaceEstimates,
        state: TrackerState,
        mean: FloatArray,
        n_seen: int | None,
        n_weak: int,
        n_faint: int,
    ) -> tuple[TrackerState, BearingTrackRows]:
        """Let the automatic start see the estimate and the running tracks; return its rows too."""
        folded, _ = folded_angles(mean[..., 0], estimates.element_positions)
        start, started = state.start.update(
            estimates, folded, n_seen, n_weak, state.ids, mean[..., 1], n_faint
        )
        faint = state.faint.anew() if started else state.faint
        if self.seeks_faint and not started:
            faint, started = faint.update(estimates, mean, start.next_id, state.steering.error)
            start = replace(start, next_id=start.next_id + len(started))
        state = replace(state, start=start, faint=faint)
        tentative = tentative_rows(start.tentative, estimates.stamp)
        if not started:
            return state, tentative
        new = started_rows(started)
        if set(new.ids) & set(state.ids):
            # One of a pair takes the place of the track that was between them.
            left = [row for row, name in enumerate(state.ids) if name not in new.ids]
            state = state.keep(self.filters, np.array(left, dtype=np.intp))
        grown = replace(
            state,
            ids=state.ids + new.ids,
            filters=self.filters.extend(state.filters, new.filters),
            existence=np.concatenate([state.existence, new.existence_probability]),
            excess=np.append(state.excess, [track.excess for track in started]),
        )
        if self.seeks_faint and np.isnan(started[0].excess):
            shown = faint_excess(estimates, self.filters.targets(grown.filters).mean)
            shown[: -len(started)] = state.excess
            grown = replace(grown, excess=shown)
        return grown, new.append(tentative)
