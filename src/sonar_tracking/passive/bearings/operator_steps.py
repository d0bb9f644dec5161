"""What an operator does to bearing tracks, between two estimates: start, end, merge.

A track that is ended is reported once more, as terminated. Where its source goes on, the automatic
start finds it again, under a new identifier.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.motion import wrap_angle
from sonar_tracking.passive.bearings.bearing_track_list import (
    BearingTrackRows,
    folded_angles,
    started_rows,
    tentative_rows,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import SQUARE_DEGREE
from sonar_tracking.passive.bearings.track_existence import STARTED
from sonar_tracking.passive.bearings.tracker_state import TrackerState
from sonar_tracking.passive.bearings.tracking_steps import TrackingSteps
from sonar_tracking.passive.track_start.tentative_track import StartedTrack
from sonar_tracking.records.bearings import SubspaceEstimates, TrackStatus

NEAREST_DEG = 1.0
"""Two tracks cannot be started nearer to each other: one source has one track."""


def with_started(
    steps: TrackingSteps, state: TrackerState, last: SubspaceEstimates, arrival_angle: float
) -> TrackerState:
    """Return the state with one more track, which does not move yet.

    Parameters
    ----------
    steps : TrackingSteps
        Of the tracker.
    state : TrackerState
        After the last estimate.
    last : SubspaceEstimates
        The last estimate.
    arrival_angle : float
        From broadside, rad.

    Raises
    ------
    InputError
        If there is a track already, or as many as the array can tell apart.
    """
    if not np.isfinite(arrival_angle) or abs(arrival_angle) > np.pi:
        raise InputError(f"the angle is {arrival_angle:g} rad; give one between -pi and pi.")
    angle = folded_angles(np.array(arrival_angle), last.element_positions)[0]
    mean = steps.filters.targets(state.filters).mean
    angles = folded_angles(mean[:, 0], last.element_positions)[0]
    near = np.flatnonzero(np.abs(wrap_angle(angles - angle)) < np.deg2rad(NEAREST_DEG))
    if near.size:
        raise InputError(
            f"track {state.ids[near[0]]} is within {NEAREST_DEG:g} degree of it already."
        )
    most = len(last.element_positions) - 1
    if not steps.needs_covariance:
        most = min(most, last.basis.shape[-1])
    if len(state.ids) >= most:
        raise InputError(f"there are {len(state.ids)} tracks, the most here; end one first.")
    given = steps.configuration
    variances = (given.initial_angle_variance_deg2, given.initial_rate_variance_deg2)
    target = KalmanState(
        np.array([[float(angle), 0.0]]), SQUARE_DEGREE * np.diag(np.array(variances))[None]
    )
    existence = STARTED if steps.automatic else np.nan
    return replace(
        state,
        ids=(*state.ids, state.start.next_id),
        filters=steps.filters.extend(state.filters, target),
        start=replace(state.start, next_id=state.start.next_id + 1),
        existence=np.append(state.existence, existence),
        excess=np.append(state.excess, np.nan),
    )


def with_ended(steps: TrackingSteps, state: TrackerState, number: int) -> TrackerState:
    """Return the state without a track, running or tentative, which is reported once more.

    Parameters
    ----------
    steps : TrackingSteps
        Of the tracker.
    state : TrackerState
        After the last estimate.
    number : int
        Identifier.

    Raises
    ------
    InputError
        If there is no such track.
    """
    tentative = tuple(track for track in state.start.tentative if track.id == number)
    if tentative:
        going_on = tuple(track for track in state.start.tentative if track.id != number)
        start = replace(state.start, tentative=going_on)
        ended = _terminated(tentative_rows(tentative, state.stamp))
        return replace(state, start=start, ended=(*state.ended, ended))
    row = _row_of(state, number)
    left = np.delete(np.arange(len(state.ids)), row)
    ended = _last_row(steps, state, row, number)
    return replace(state.keep(steps.filters, left), ended=(*state.ended, ended))


def with_merged(steps: TrackingSteps, state: TrackerState, number: int, other: int) -> TrackerState:
    """Return the state in which two tracks are one: the more certain one, with the first name.

    Parameters
    ----------
    steps : TrackingSteps
        Of the tracker.
    state : TrackerState
        After the last estimate.
    number, other : int
        Identifiers; the second one ends.

    Raises
    ------
    InputError
        If there is no such track, or the first is only tentative.
    """
    first = _row_of(state, number)
    if other not in state.ids:
        return with_ended(steps, state, other)
    second = _row_of(state, other)
    variance = steps.filters.targets(state.filters).covariance[:, 0, 0]
    worse = first if variance[second] < variance[first] else second
    ids = list(state.ids)
    ids[first + second - worse] = number
    existence = state.existence.copy()
    existence[first + second - worse] = np.fmax(existence[first], existence[second])
    ended = _last_row(steps, state, second, other)
    named = replace(state, ids=tuple(ids), existence=existence)
    left = np.delete(np.arange(len(ids)), worse)
    return replace(named.keep(steps.filters, left), ended=(*state.ended, ended))


def _row_of(state: TrackerState, number: int) -> int:
    if number not in state.ids:
        running = ", ".join(map(str, state.ids)) or "none"
        raise InputError(f"no bearing track {number} runs; there are {running}.")
    return state.ids.index(number)


def _last_row(steps: TrackingSteps, state: TrackerState, row: int, number: int) -> BearingTrackRows:
    """Return a running track as it is to be reported once more."""
    targets = steps.filters.targets(state.filters)
    track = StartedTrack(number, targets.mean[row], targets.covariance[row])
    return _terminated(started_rows((track,)))


def _terminated(rows: BearingTrackRows) -> BearingTrackRows:
    status = (TrackStatus.TERMINATED,) * len(rows.ids)
    return replace(rows, status=status, existence_probability=np.full(len(rows.ids), np.nan))
