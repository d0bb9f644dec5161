"""The bearings of one station at one instant: checked, in ``map``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.errors import InputError, Notice, Severity, shown
from sonar_tracking.fusion.fused_target import Contributor
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.targets.bearing_observations import left_out, observation_of
from sonar_tracking.tma.targets.station_view import station_view
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration


@dataclass(frozen=True)
class StationBearings:
    """What a station heard.

    Attributes
    ----------
    alive : dict of BearingKey to Contributor
        All bearing tracks that go on.
    found : tuple of HeardBearing
        What was measured now.
    notices : tuple of Notice
        What could not be used.
    """

    alive: dict[BearingKey, Contributor]
    found: tuple[HeardBearing, ...]
    notices: tuple[Notice, ...] = ()


def with_names_of_their_own(
    stations: Sequence[BearingTracks], notices: list[Notice]
) -> list[BearingTracks]:
    """Return the first of each name; of others, the notices are told."""
    first: dict[str, BearingTracks] = {}
    for bearings in stations:
        sensor = bearings.sensor.sensor_id
        if first.setdefault(sensor, bearings) is not bearings:
            text = (
                f"two stations claim the sensor_id {shown(sensor)}: the second one is left out; "
                "give each a name of its own."
            )
            notices.append(Notice(Severity.ERROR, f"data of {shown(sensor)}", text))
    return list(first.values())


def station_bearings(
    bearings: BearingTracks,
    own_ship: KinematicState | None,
    array: int,
    configuration: TrackFusionConfiguration,
) -> StationBearings:
    """Return what a station heard.

    Parameters
    ----------
    bearings : BearingTracks
        Its list.
    own_ship : KinematicState or None
        At the stamp; None = not known.
    array : int
        Number of its misalignment.
    configuration : TrackFusionConfiguration
        Floors, and where an array is whose data do not tell.
    """
    sensor = bearings.sensor.sensor_id
    stamp = bearings.stamp / NANOSECONDS
    rows = np.flatnonzero(bearings.status != TrackStatus.TERMINATED)
    keys: list[BearingKey] = [(sensor, number) for number in bearings.id[rows].tolist()]
    states = bearings.status[rows].tolist(), bearings.existence_probability[rows].tolist()
    alive = {
        key: Contributor(TrackStatus(status), existence, math.nan)
        for key, status, existence in zip(keys, *states, strict=True)
    }
    settings = _settings(configuration)
    try:
        view = station_view(bearings.sensor, own_ship, settings)
    except InputError as error:
        problem = Notice(Severity.ERROR, f"data of {sensor}", str(error))
        return StationBearings(alive, (), (problem,))
    found, notices = [], []
    station, lag = np.array(view.position), configuration.clock_offset(sensor)
    for key, row in zip(keys, rows.tolist(), strict=True):
        observation, wrong = observation_of(bearings, row, view, settings)
        if wrong:
            notices.append(left_out(sensor, wrong))
        if observation.azimuths:
            alive[key].updated = stamp
            variance = float(observation.azimuth_variance)
            heard = HeardBearing(key, observation.azimuths, variance, station, array, lag)
            found.append(heard)
    return StationBearings(alive, tuple(found), tuple(notices))


@lru_cache(maxsize=4)
def _settings(configuration: TrackFusionConfiguration) -> TmaTrackerConfiguration:
    return TmaTrackerConfiguration(
        sound_speed=configuration.sound_speed,
        travel_time=configuration.travel_time,
        minimum_azimuth_deviation_deg=configuration.minimum_azimuth_deviation_deg,
        mounting_x=configuration.mounting_x,
        mounting_y=configuration.mounting_y,
        mounting_yaw_deg=configuration.mounting_yaw_deg,
    )
