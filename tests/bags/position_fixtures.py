"""Position tracks, contacts and odometry as serialised messages, made without ROS."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sonar_tracking.active.records import Contacts
from sonar_tracking.bags.message_definitions import installed_typestore
from sonar_tracking.position_tracks import COLUMNS, PositionTracks
from sonar_tracking.simulation.records import OwnShipState
from tests.bags.bag_fixtures import SECOND, filled

POSITIONS = "sonar_tracking_msgs/msg/Tracks"
CONTACTS = "sonar_tracking_msgs/msg/Contacts"
ODOMETRY = "nav_msgs/msg/Odometry"


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
