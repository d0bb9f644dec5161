"""Position tracks with hindsight: each row of a recorded list, from all its measurements at once.

A row of the list says which bearing tracks it was made of. All that was measured along them, before
and after, goes into :func:`~sonar_tracking.tma.batch.target_smoother.smooth_target`, which starts
from where the tracker had the target. A station that joined a target, and stayed, saw it before,
too: the row it had until then is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import BoolArray, CodeArray, FloatArray
from sonar_tracking.records.bearings import TrackStatus, established
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import seconds
from sonar_tracking.tma.batch.target_history import TargetHistory
from sonar_tracking.tma.batch.target_smoother import TargetSmootherConfiguration, smooth_target
from sonar_tracking.tma.batch.track_smoother import TrackPath, smooth_path
from sonar_tracking.tma.targets.hearing import Hearing
from sonar_tracking.tma.targets.observation_log import Observations
from sonar_tracking.tma.targets.target_records import MAXIMUM_LINES, TargetObservation
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.recorded_rows import RecordedRows, joined_later, recorded_rows
from sonar_tracking.tma.tracker.track_rows import stopped

FEWEST_HEARD = 10
"""A line heard in fewer frames says less than it costs."""


@dataclass(frozen=True)
class SmoothedTracks:
    """What came of the tracks of a recording.

    Attributes
    ----------
    pictures : tuple of PositionTracks
        One for each that was given, of source SMOOTHED; rows of other sources are left out, and
        those that turned out to be of another row's target.
    n_tracks : int
        Rows by identifier.
    without_measurements, failed : tuple of int
        Identifiers of those nothing was measured of, and of those whose path could not be found
        from what was measured: these are smoothed from the list alone.
    """

    pictures: tuple[PositionTracks, ...]
    n_tracks: int
    without_measurements: tuple[int, ...]
    failed: tuple[int, ...]


def smooth_tracks(
    pictures: Sequence[PositionTracks],
    observations: Observations,
    tracker: TmaTrackerConfiguration,
    smoother: TargetSmootherConfiguration,
    done: Callable[[int, int], None] = lambda _done, _total: None,
) -> SmoothedTracks:
    """Return the tracks of target motion analysis in all pictures, smoothed.

    Parameters
    ----------
    pictures : sequence of PositionTracks
        All of a recording, of one tracker, in order.
    observations : dict
        What was observed along each bearing track, by stamp.
    tracker : TmaTrackerConfiguration
        Of the tracker: speed of sound, height of targets, what is confirmed.
    smoother : TargetSmootherConfiguration
        Parameters.
    done : callable
        Called with the number of tracks that are done, and that of all of them.
    """
    kept = [picture.selected(_usable(picture)) for picture in pictures]
    recorded = recorded_rows(kept)
    states = [picture.state.copy() for picture in kept]
    covariances = [picture.covariance.copy() for picture in kept]
    statuses = [picture.status.copy() for picture in kept]
    unmeasured, failed = [], []
    for number, (identifier, track) in enumerate(recorded.items()):
        history = _history(track, observations, tracker)
        start = _start(track, smoother)
        confirmed = np.flatnonzero(established(track.status))
        ever = bool(confirmed.size)
        # A side that was never confirmed is as uncertain as the list says.
        path = _smoothed(track, start, history, smoother) if history and ever else None
        if history is None:
            unmeasured.append(identifier)
        elif ever and path is None:
            failed.append(identifier)
        # What the list says of itself has the size of the target in it.
        size = np.zeros((4, 4)) if path is None else _size(tracker)
        path = path or start
        known = _known(path, history, tracker)
        silent = _silent(track, history)
        for place, (index, row) in enumerate(track.places):
            state = path.mean[place]
            states[index][row] = state
            covariances[index][row] = path.covariance[place] + size + stopped(state, silent[place])
            # What contradicted a position that was confirmed does so with hindsight, too.
            if ever and known[place] and place < confirmed[0]:
                statuses[index][row] = TrackStatus.CONFIRMED
        done(number + 1, len(recorded))
    columns = zip(kept, states, covariances, statuses, strict=True)
    smoothed = tuple(_picture(*each) for each in columns)
    other = joined_later(recorded)
    left = tuple(
        picture.selected(np.array([(index, row) not in other for row in range(len(picture))], bool))
        for index, picture in enumerate(smoothed)
    )
    return SmoothedTracks(left, len(recorded), tuple(unmeasured), tuple(failed))


def _picture(
    picture: PositionTracks, state: FloatArray, covariance: FloatArray, status: CodeArray
) -> PositionTracks:
    """Return a picture with what smoothing changes."""
    source = np.full(len(picture), TrackSource.SMOOTHED, np.uint8)
    return replace(picture, state=state, covariance=covariance, status=status, source=source)


def _usable(picture: PositionTracks) -> BoolArray:
    known = np.isfinite(picture.state).all(axis=1) & np.isfinite(picture.covariance).all((1, 2))
    return np.asarray(known & (picture.source == TrackSource.TMA))


def _history(
    track: RecordedRows, observations: Observations, tracker: TmaTrackerConfiguration
) -> TargetHistory | None:
    """Return what was measured of a track, an empty instant where a picture has no measurement."""
    chosen = _chosen(track, observations)
    if not chosen:
        return None
    stamps = {one.stamp for one in chosen}
    empty: list[tuple[int, TargetObservation | None]] = [
        (stamp, None) for stamp in track.stamps if stamp not in stamps
    ]
    instants = sorted([*_heard(track, chosen), *empty], key=lambda each: each[0])
    sensors = {one.sensor_id: index for index, one in reversed(list(enumerate(chosen)))}
    number = {
        sensor: index for index, sensor in enumerate(sorted(sensors, key=sensors.__getitem__))
    }
    columns = {line: index for index, line in enumerate(_lines(chosen))}
    n = len(instants)
    measured = np.full((n, 5), np.nan)
    place = np.zeros((n, 4))
    station = np.zeros(n, np.int64)
    frequency, deviation = np.full((2, n, len(columns)), np.nan)
    for index, (_, one) in enumerate(instants):
        if one is None:
            continue
        station[index] = number[one.sensor_id]
        place[index] = (*one.position, *one.velocity)
        measured[index, : len(one.azimuths)] = one.azimuths
        measured[index, 2:] = one.azimuth_variance, one.elevation, one.elevation_variance
        for line, value, spread in zip(
            one.line_ids, one.frequencies, one.frequency_deviations, strict=True
        ):
            column = columns.get((one.sensor_id, line))
            if column is not None:
                frequency[index, column], deviation[index, column] = value, spread
    history = TargetHistory(
        times=np.array([seconds(stamp - track.stamps[0]) for stamp, _ in instants]),
        station=station,
        position=place[:, :2],
        velocity=place[:, 2:],
        azimuth=measured[:, :2],
        azimuth_deviation=np.sqrt(measured[:, 2]),
        # Where heights are estimated elevations say nothing of the path on the plane.
        elevation=np.where(tracker.height_deviation == 0.0, measured[:, 3], np.nan),
        elevation_deviation=np.sqrt(measured[:, 4]),
        height=tracker.target_height,
        frequency=frequency,
        frequency_deviation=deviation,
        sound_speed=tracker.sound_speed,
        propagation_speed=tracker.propagation_speed,
        bending=tracker.systematic_errors.bending,
    )
    return history if _measured(history).any() else None


def _measured(history: TargetHistory) -> BoolArray:
    """Return at which instants something was measured, shape (n,)."""
    return np.asarray(np.isfinite(history.deviations).any(axis=1))


def _heard(
    track: RecordedRows, chosen: Sequence[TargetObservation]
) -> list[tuple[int, TargetObservation | None]]:
    """Return what was observed and when, ns; nothing where the target was not heard.

    The list says where what was observed was of something else, and its row coasted.
    """
    coasted = track.status == TrackStatus.COASTED
    elsewhere = {stamp for stamp, silent in zip(track.stamps, coasted, strict=True) if silent}
    hearing = Hearing()
    instants: list[tuple[int, TargetObservation | None]] = []
    for one in sorted(chosen, key=lambda one: one.stamp):
        heard = not one.azimuths or (hearing.take(one) and one.stamp not in elsewhere)
        instants.append((one.stamp, one if heard else None))
    return instants


def _silent(track: RecordedRows, history: TargetHistory | None) -> FloatArray:
    """Return how long before or after each coasted row its target was heard, s, shape (n,).

    Of rows that are not coasted, and where nothing was measured, that is 0.
    """
    times = track.path.times
    if history is None:
        return np.zeros(len(times))
    heard = history.times[_measured(history)]
    after = np.searchsorted(heard, times)
    before = times - heard[np.maximum(after - 1, 0)]
    until = np.where(after < len(heard), heard[np.minimum(after, len(heard) - 1)] - times, np.inf)
    apart = np.minimum(np.abs(before), until)
    return np.where(track.status == TrackStatus.COASTED, apart, 0.0)


def _chosen(track: RecordedRows, observations: Observations) -> list[TargetObservation]:
    """Return what was observed along the bearing tracks of a row while they were its own."""
    keys = sorted(set().union(*track.members))
    chosen = []
    for key in keys:
        own = [
            stamp for stamp, heard in zip(track.stamps, track.members, strict=True) if key in heard
        ]
        along = observations.get(key, {})
        if not along:
            continue
        stayed = own[-1] == track.stamps[-1] or own[-1] >= max(along)
        first = track.stamps[0] if stayed else own[0]
        chosen += [one for stamp, one in along.items() if first <= stamp <= own[-1]]
    return chosen


def _lines(chosen: Sequence[TargetObservation]) -> list[tuple[str, int]]:
    """Return the lines heard most often, station and identifier."""
    count: dict[tuple[str, int], int] = {}
    for one in chosen:
        for line in one.line_ids:
            count[one.sensor_id, line] = count.get((one.sensor_id, line), 0) + 1
    often = [line for line, heard in count.items() if heard >= FEWEST_HEARD]
    return sorted(often, key=lambda line: (-count[line], line))[:MAXIMUM_LINES]


def _start(track: RecordedRows, smoother: TargetSmootherConfiguration) -> TrackPath:
    """Return the path as the list alone tells it."""
    try:
        return smooth_path(track.path, smoother.acceleration)
    except np.linalg.LinAlgError:
        return track.path


def _smoothed(
    track: RecordedRows,
    start: TrackPath,
    history: TargetHistory,
    smoother: TargetSmootherConfiguration,
) -> TrackPath | None:
    """Return the path at the stamps of the list; None where it cannot be found."""
    between = np.stack(
        [np.interp(history.times, start.times, start.mean[:, axis]) for axis in range(4)], axis=1
    )
    prior = KalmanState(track.path.mean[0], track.path.covariance[0])
    try:
        found = smooth_target(history, between, prior, smoother)
    except np.linalg.LinAlgError:
        return None
    if not (np.isfinite(found.mean).all() and np.isfinite(found.covariance).all()):
        return None
    # The last of the instants of one time; all of them have the same state.
    where = np.searchsorted(history.times, track.path.times, side="right") - 1
    return TrackPath(track.path.times, found.mean[where], found.covariance[where])


def _size(tracker: TmaTrackerConfiguration) -> FloatArray:
    """Return the covariance of where on a target what is heard comes from, shape (4, 4), m^2."""
    return np.diag([tracker.target_size**2, tracker.target_size**2, 0.0, 0.0])


def _known(
    path: TrackPath, history: TargetHistory | None, tracker: TmaTrackerConfiguration
) -> BoolArray:
    """Return where a position is known as well as a confirmation takes, shape (n,)."""
    if history is None:
        return np.zeros(len(path.times), bool)
    heard = _measured(history)
    nearest = np.searchsorted(history.times[heard], path.times, side="right") - 1
    place = history.position[heard][np.maximum(nearest, 0)]
    distance = np.hypot(*(path.mean[:, :2] - place).T)
    variance = np.linalg.eigvalsh(path.covariance[:, :2, :2])[:, -1]
    return np.asarray(variance <= (tracker.confirm_relative_deviation * distance) ** 2)
