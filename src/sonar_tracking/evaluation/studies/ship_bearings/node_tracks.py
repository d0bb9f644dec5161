"""The ship of the ship-bearings study as the node tracks it, and with hindsight.

The stage that the node runs, with its defaults, fed frame by frame as in the graph, so that its
rows are those of the node to the last bit. It is told the depth of the arrays, which whoever laid
them knows, and the speed of sound; each array reports one bearing track, outliers left in. Only
confirmed rows count.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.evaluation.studies.ship_bearings.data import ArrayBearings
from sonar_tracking.evaluation.studies.ship_bearings.tracks import (
    BOTH,
    CROSS,
    SINGLE,
    ShipTrack,
)
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.positions import MAP_FRAME, PositionTracks
from sonar_tracking.records.time import nanoseconds, seconds
from sonar_tracking.tma.batch.target_smoother import TargetSmootherConfiguration
from sonar_tracking.tma.targets.observation_log import ObservationLog
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from sonar_tracking.tma.tracker.track_smoothing import smooth_tracks

NODE, HINDSIGHT = "node: ", "node smoothed: "
"""How the names of the node's tracks begin, and of the same with hindsight."""

SMOOTHER = TargetSmootherConfiguration()


def node_tracks(arrays: tuple[ArrayBearings, ...]) -> tuple[ShipTrack, ...]:
    """Return the confirmed rows of the node, and the same with hindsight.

    Parameters
    ----------
    arrays : tuple of ArrayBearings
        What was measured.
    """
    tracks: list[ShipTrack] = []
    for array in arrays:
        tracks.extend(_tracked(SINGLE, (array,), True))
    if len(arrays) > 1:
        tracks.extend(_tracked(CROSS, arrays, False))
        tracks.extend(_tracked(BOTH, arrays, True))
    return tuple(tracks)


def frames_of(arrays: Sequence[ArrayBearings], elevations: bool) -> tuple[PassiveFrame, ...]:
    """Return the bearings of arrays as frames of target motion analysis.

    Parameters
    ----------
    arrays : sequence of ArrayBearings
        What was measured; each reports one bearing track.
    elevations : bool
        Whether to report elevations.
    """
    bearings: dict[int, list[BearingTracks]] = {}
    for array in arrays:
        deviation = array.azimuth_deviation()
        for index, time in enumerate(array.times):
            one = _bearings(array, index, deviation[index : index + 1], elevations)
            bearings.setdefault(nanoseconds(float(time)), []).append(one)
    return tuple(PassiveFrame(stamp, tuple(bearings[stamp])) for stamp in sorted(bearings))


def live_track(system: str, arrays: tuple[ArrayBearings, ...], elevations: bool) -> ShipTrack:
    """Return the confirmed rows of the node.

    Parameters
    ----------
    system : str
        How the ship is located, for the name of the track.
    arrays : tuple of ArrayBearings
        What was measured.
    elevations : bool
        Whether the arrays report elevations.
    """
    return _scored(NODE + system, arrays, _live(arrays, elevations), _depth(arrays))


def _tracked(
    system: str, arrays: tuple[ArrayBearings, ...], elevations: bool
) -> tuple[ShipTrack, ShipTrack]:
    configuration = _configuration(arrays, elevations)
    pictures = _live(arrays, elevations)
    log = ObservationLog(configuration)
    log.add_all(frames_of(arrays, elevations))
    smoothed = smooth_tracks(pictures, log.observations, configuration, SMOOTHER).pictures
    depth = _depth(arrays)
    live = _scored(NODE + system, arrays, pictures, depth)
    return live, _scored(HINDSIGHT + system, arrays, smoothed, depth)


def _depth(arrays: Sequence[ArrayBearings]) -> float:
    return float(np.mean([-array.position[2] for array in arrays]))


def _configuration(arrays: Sequence[ArrayBearings], elevations: bool) -> TmaTrackerConfiguration:
    return TmaTrackerConfiguration(
        sound_speed=arrays[0].sound_speed, target_height=_depth(arrays) if elevations else 0.0
    )


def _live(arrays: Sequence[ArrayBearings], elevations: bool) -> list[PositionTracks]:
    stage = TmaTrackerStage(_configuration(arrays, elevations), len(arrays))
    updates = [stage.update(frame).tracks for frame in frames_of(arrays, elevations)]
    return [tracks for tracks in updates if tracks is not None]


def _bearings(
    array: ArrayBearings, index: int, deviation: FloatArray, elevations: bool
) -> BearingTracks:
    azimuth = array.azimuth[index : index + 1]
    variance = deviation**2
    unknown = np.full(1, np.nan)
    nothing = np.empty(0)
    return BearingTracks(
        stamp=nanoseconds(float(array.times[index])),
        id=np.ones(1, np.uint64),
        status=np.full(1, TrackStatus.CONFIRMED, np.uint8),
        arrival_angle=azimuth,
        arrival_angle_rate=np.zeros(1),
        covariance=np.diag([variance[0], 1e-4])[None],
        measurement=azimuth,
        measurement_variance=variance,
        innovation=unknown,
        signal_to_noise_ratio=unknown,
        existence_probability=unknown,
        ambiguous=np.zeros(1, bool),
        sensor=Sensor(
            array.name,
            MAP_FRAME,
            (float(array.position[0]), float(array.position[1]), float(array.position[2])),
            (0.0, 0.0, 0.0, 1.0),
            (0.0, 0.0, 0.0),
        ),
        angle_kind=AngleKind.AZIMUTH,
        elevation=array.elevation[index : index + 1] if elevations else nothing,
        elevation_variance=array.deviation[index : index + 1] ** 2 if elevations else nothing,
    )


def _scored(
    system: str,
    arrays: tuple[ArrayBearings, ...],
    pictures: Sequence[PositionTracks],
    depth: float,
) -> ShipTrack:
    """Return the rows, confirmed or coasted, referred to when the sound left, as the truth is.

    Those of instants at which GPS tells where the ship is.
    """
    ships = {
        nanoseconds(float(time)): (array, ship)
        for array in arrays
        for time, ship in zip(array.times, array.ship, strict=True)
        if np.isfinite(ship).all()
    }
    pictures = [picture for picture in pictures if picture.stamp in ships]
    times, positions, truths, nees, coasted = [], [], [], [], []
    for picture in pictures:
        array, ship = ships[picture.stamp]
        for row in np.flatnonzero(picture.established):
            offset = picture.state[row, :2] - array.position[:2]
            delay = np.hypot(np.hypot(*offset), depth) / array.sound_speed
            position = picture.state[row, :2] - delay * picture.state[row, 2:]
            error, covariance = position - ship, picture.covariance[row, :2, :2]
            times.append(seconds(picture.stamp))
            positions.append(position)
            truths.append(ship)
            nees.append(float(normalised_squared(error, covariance)))
            coasted.append(bool(picture.status[row] == TrackStatus.COASTED))
    return ShipTrack(
        system,
        " and ".join(array.name for array in arrays),
        np.array(times),
        _pairs(positions),
        _pairs(truths),
        np.array(nees),
        instants=len(pictures),
        coasted=np.array(coasted, bool),
    )


def _pairs(values: list[FloatArray]) -> FloatArray:
    return np.array(values).reshape(-1, 2)
