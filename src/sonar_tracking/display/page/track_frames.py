"""Frames of tracks, bearings, lines and own ship."""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import (
    Frame,
    rounded,
    seconds_of,
    text_frame,
    upper_triangle,
)
from sonar_tracking.errors import InputError
from sonar_tracking.own_ship_interpolation import motion_in_map
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.scene.told_mountings import array_as_told
from sonar_tracking.tma.targets import station_view
from sonar_tracking.tma.targets.station_view import StationView


def own_ship_frame(state: OwnShipState) -> Frame:
    """Return the frame of own ship's state: position, yaw, velocity in ``map``."""
    return text_frame("own_ship", seconds_of(state.stamp), **_ship(state))


def ship_frame(topic: str, state: OwnShipState) -> Frame:
    """Return the frame of the same state of another ship of own side."""
    return text_frame("ship", seconds_of(state.stamp), topic, topic=topic, **_ship(state))


def _ship(state: OwnShipState) -> dict[str, float]:
    velocity = motion_in_map(state).velocity
    return {
        "x": state.position[0],
        "y": state.position[1],
        "yaw": state.yaw,
        "vx": float(velocity[0]),
        "vy": float(velocity[1]),
    }


def tracks_frame(topic: str, tracks: PositionTracks) -> Frame:
    """Return the frame of position tracks.

    The covariances are ``[xx, xy, yy]`` of the position, m^2, and of the velocity, m^2/s^2; a
    contributor is ``[row, source, sensor, id]``, a line ``[row, id, Hz, deviation in Hz]``.
    """
    columns = {
        name: getattr(tracks, name)
        for name in (
            *("id", "status", "source", "existence_probability", "initiated", "updated"),
            *("observability", "hypothesis", "hypothesis_probability", "bearing_track_id"),
        )
    }
    columns |= dict(zip(("x", "y", "vx", "vy"), tracks.state.T, strict=True))
    contributors = zip(
        tracks.contributor_track.tolist(),
        tracks.contributor_source.tolist(),
        tracks.contributor_sensor,
        tracks.contributor_id.tolist(),
        strict=True,
    )
    lines = zip(
        tracks.line_track.tolist(),
        tracks.line_id.tolist(),
        tracks.line_frequency.tolist(),
        tracks.line_frequency_standard_deviation.tolist(),
        strict=True,
    )
    return text_frame(
        "tracks",
        seconds_of(tracks.stamp),
        topic,
        topic=topic,
        **columns,
        position_covariance=rounded(upper_triangle(tracks.covariance[:, :2, :2])),
        velocity_covariance=rounded(upper_triangle(tracks.covariance[:, 2:, 2:])),
        contributors=[list(entry) for entry in contributors],
        lines=[list(entry) for entry in lines],
    )


class StationPlaces:
    """Where the stations are whose bearings are shown, as the trackers take it.

    Parameters
    ----------
    configuration : PageConfiguration
        Mounting of an array that does not tell its pose.
    own_ship : OwnShipLog
        Own ship.
    """

    def __init__(self, configuration: PageConfiguration, own_ship: OwnShipLog) -> None:
        self._own_ship = own_ship
        self._mounting = array_as_told(configuration)

    def view(self, sensor: Sensor, stamp: int) -> StationView | None:
        """Return a station at a stamp, ns; None = nobody can tell where it is."""
        own_ship = self._own_ship.motion_at(stamp)
        judged, _ = station_view.with_pose_judged(
            sensor, own_ship, self._mounting, self._own_ship.is_known
        )
        try:
            return station_view.station_view(judged, own_ship, self._mounting)
        except InputError:
            return None


def bearings_frame(topic: str, tracks: BearingTracks, view: StationView | None) -> Frame:
    """Return the frame of bearing tracks.

    ``azimuth`` and ``other_azimuth`` are the directions in ``map``, rad, left and right of a line
    array; null where there is one only, or nobody knows how the array lies.
    """
    kind = AngleKind(int(tracks.angle_kind))
    azimuths = np.full((len(tracks.id), 2), math.nan)
    if view is not None:
        for row, angle in enumerate(tracks.arrival_angle):
            found = view.azimuths(float(angle), kind, bool(tracks.ambiguous[row]))
            azimuths[row, : len(found)] = found
    columns = {
        name: getattr(tracks, name)
        for name in (
            *("id", "status", "arrival_angle", "arrival_angle_rate", "measurement"),
            *("measurement_variance", "signal_to_noise_ratio", "existence_probability"),
            *("ambiguous",),
        )
    }
    return text_frame(
        "bearings",
        seconds_of(tracks.stamp),
        topic,
        topic=topic,
        angle_kind=kind.name.lower(),
        **columns,
        deviation=rounded(np.sqrt(np.maximum(tracks.covariance[:, 0, 0], 0.0))),
        azimuth=azimuths[:, 0],
        other_azimuth=azimuths[:, 1],
        sensor=_sensor(tracks.sensor, view),
    )


def lines_frame(topic: str, lines: FrequencyLines) -> Frame:
    """Return the frame of the lines heard at one instant."""
    names = (
        *("track_id", "arrival_angle", "line_id", "frequency", "standard_deviation"),
        *("signal_to_noise_ratio", "integration_time"),
    )
    columns = {name: getattr(lines, name) for name in names}
    sensor = _sensor(lines.sensor, None)
    return text_frame(
        "lines", seconds_of(lines.stamp), topic, topic=topic, **columns, sensor=sensor
    )


def alignment_frame(topic: str, alignments: ArrayAlignments) -> Frame:
    """Return the frame of how the arrays are turned."""
    return text_frame(
        "alignment",
        seconds_of(alignments.stamp),
        topic,
        topic=topic,
        sensor_id=alignments.sensor_id,
        misalignment=alignments.misalignment,
        standard_deviation=alignments.misalignment_standard_deviation,
    )


def _sensor(sensor: Sensor, view: StationView | None) -> dict[str, object]:
    x, y = view.position if view else (math.nan, math.nan)
    axis = view.axis if view else math.nan
    return {"id": sensor.sensor_id, "x": x, "y": y, "axis_azimuth": axis}
