"""Tracks, contacts, lines and odometry as serialised messages, made without ROS."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.message_reading.sample_reading import LOFAR_AXIS
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import COLUMNS, PositionTracks
from tests.bags.bag_fixtures import SECOND, filled

BEARINGS = "sonar_tracking_msgs/msg/BearingTracks"
POSITIONS = "sonar_tracking_msgs/msg/Tracks"
CONTACTS = "sonar_tracking_msgs/msg/Contacts"
ODOMETRY = "nav_msgs/msg/Odometry"
LINES = "sonar_tracking_msgs/msg/FrequencyLines"
IMAGE = "sensor_msgs/msg/Image"
COMMANDS = "sonar_tracking_msgs/msg/OperatorCommand"


def position_tracks_cdr(tracks: PositionTracks) -> bytes:
    """Return a serialised list of position tracks."""
    columns: dict[str, Any] = {
        name: getattr(tracks, name).reshape(-1) for name in COLUMNS if name != "state"
    }
    for index, name in enumerate(("x", "y", "vx", "vy")):
        columns[name] = np.ascontiguousarray(tracks.state[:, index])
    message = filled(POSITIONS, contributor_sensor=list(tracks.contributor_sensor), **columns)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(tracks.stamp, SECOND)
    message.header.frame_id = tracks.frame_id
    return bytes(installed_typestore(POSITIONS).serialize_cdr(message, POSITIONS))


def contacts_cdr(ping: Contacts) -> bytes:
    """Return a serialised ping: ranges, azimuths in ``map``, amplitudes and the sensor's place."""
    message = filled(CONTACTS, range=ping.range, azimuth=ping.azimuth, amplitude=ping.amplitude)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(ping.stamp, SECOND)
    message.header.frame_id = "map"
    place, velocity = message.sensor_pose.position, message.sensor_velocity
    place.x, place.y = ping.sensor_position
    velocity.x, velocity.y = ping.sensor_velocity
    message.sensor_pose.orientation.w = 1.0
    return bytes(installed_typestore(CONTACTS).serialize_cdr(message, CONTACTS))


def command_cdr(stamp: int) -> bytes:
    """Return a serialised command: a line at 50 Hz is own ship's."""
    fields = {"command": 6, "topic": "passive/tracks", "frequency": 50.0}
    message = filled(COMMANDS, **fields)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, SECOND)
    return bytes(installed_typestore(COMMANDS).serialize_cdr(message, COMMANDS))


def odometry_cdr(state: OwnShipState) -> bytes:
    """Return a serialised state of own ship."""
    message = filled(ODOMETRY)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(state.stamp, SECOND)
    message.header.frame_id = "map"
    message.pose.covariance = message.twist.covariance = np.zeros(36)
    pose, twist = message.pose.pose, message.twist.twist
    pose.position.x, pose.position.y = state.position
    pose.orientation.z, pose.orientation.w = math.sin(state.yaw / 2), math.cos(state.yaw / 2)
    twist.linear.x, twist.linear.y = state.velocity
    return bytes(installed_typestore(ODOMETRY).serialize_cdr(message, ODOMETRY))


def frequency_lines_cdr(stamp: int, frequencies: list[float]) -> bytes:
    """Return serialised lines 1, 2, ... of bearing track 4."""
    n = len(frequencies)
    message = filled(
        LINES,
        line_id=np.arange(1, n + 1, dtype=np.uint64),
        track_id=np.full(n, 4, np.uint64),
        frequency=np.array(frequencies),
    )
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, SECOND)
    return bytes(installed_typestore(LINES).serialize_cdr(message, LINES))


def lofar_cdr(stamp: int, levels_db: NDArray[np.float32]) -> bytes:
    """Return a serialised row of bearing track 4, shape (n_bins,), from 100 Hz in half hertz."""
    axis = np.array([(4, 100.0, 0.5)], LOFAR_AXIS)
    data = np.frombuffer(levels_db.astype("<f4").tobytes() + axis.tobytes(), np.uint8)
    message = filled(
        IMAGE, height=1, width=len(levels_db), encoding="32FC1", step=len(data), data=data
    )
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, SECOND)
    return bytes(installed_typestore(IMAGE).serialize_cdr(message, IMAGE))


def bearings_cdr(tracks: BearingTracks) -> bytes:
    """Return serialised bearing tracks with all columns and the pose of their sensor."""
    names = (
        *("id", "status", "arrival_angle", "arrival_angle_rate", "covariance", "measurement"),
        *("measurement_variance", "innovation", "signal_to_noise_ratio"),
        *("existence_probability", "ambiguous", "elevation", "elevation_variance"),
    )
    columns = {name: np.ascontiguousarray(np.ravel(getattr(tracks, name))) for name in names}
    sensor = tracks.sensor
    message = filled(
        BEARINGS, sensor_id=sensor.sensor_id, angle_kind=int(tracks.angle_kind), **columns
    )
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(tracks.stamp, SECOND)
    message.header.frame_id = sensor.frame_id
    pose, velocity = message.sensor_pose, message.sensor_velocity
    pose.position.x, pose.position.y, pose.position.z = sensor.position
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w = sensor.orientation
    velocity.x, velocity.y, velocity.z = sensor.velocity
    return bytes(installed_typestore(BEARINGS).serialize_cdr(message, BEARINGS))
