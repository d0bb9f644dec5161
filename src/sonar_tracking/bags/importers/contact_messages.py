"""Serialised pings, odometry and true positions made without ROS, for imported contacts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from sonar_tracking.bags.storage.message_definitions import installed_typestore
from sonar_tracking.message_reading.contact_reading import CONTACT_REALS, DEVIATIONS
from sonar_tracking.message_reading.position_reading import STATE_NAMES
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import COLUMNS, MAP_FRAME, TrackSource, TruthTracks
from sonar_tracking.records.time import NANOSECONDS

CONTACTS_TYPE = "sonar_tracking_msgs/msg/Contacts"
ODOMETRY_TYPE = "nav_msgs/msg/Odometry"
TRACKS_TYPE = "sonar_tracking_msgs/msg/Tracks"
OWN_SHIP_FRAME = "own_ship/base_link"


def contacts_cdr(contacts: Contacts) -> bytes:
    """Return a serialised Contacts message; the sensor's height is zero."""
    types = installed_typestore(CONTACTS_TYPE).types
    values = {
        "header": _header(types, contacts.stamp, contacts.frame_id),
        "next_stamp": _time(types, contacts.next_stamp),
        "sensor_id": contacts.sensor_id,
        "sensor_pose": _pose(types, contacts.sensor_position, contacts.sensor_yaw),
        "sensor_velocity": types["geometry_msgs/msg/Vector3"](*contacts.sensor_velocity, 0.0),
        "expected_signal_to_noise_ratio": contacts.signal_to_noise_ratio_linear,
    }
    for name in ("range", "azimuth", "amplitude", *DEVIATIONS):
        column = np.atleast_1d(np.asarray(getattr(contacts, name), dtype=np.float64))
        values[name] = np.ascontiguousarray(column)
    values.update({name: float(getattr(contacts, name)) for name in CONTACT_REALS})
    return _serialised(CONTACTS_TYPE, values)


def odometry_cdr(state: OwnShipState) -> bytes:
    """Return a serialised Odometry message: pose in ``map``, twist in ``own_ship/base_link``."""
    types = installed_typestore(ODOMETRY_TYPE).types
    vector = types["geometry_msgs/msg/Vector3"]
    twist = types["geometry_msgs/msg/Twist"](
        vector(*state.velocity, 0.0), vector(0.0, 0.0, state.yaw_rate)
    )
    unknown = np.zeros(36)
    values = {
        "header": _header(types, state.stamp, MAP_FRAME),
        "child_frame_id": OWN_SHIP_FRAME,
        "pose": types["geometry_msgs/msg/PoseWithCovariance"](
            _pose(types, state.position, state.yaw), unknown
        ),
        "twist": types["geometry_msgs/msg/TwistWithCovariance"](twist, unknown),
    }
    return _serialised(ODOMETRY_TYPE, values)


def truth_tracks_cdr(truth: TruthTracks) -> bytes:
    """Return true positions as a serialised Tracks message of source TRUTH."""
    types = installed_typestore(TRACKS_TYPE).types
    count = len(truth.id)
    state = np.concatenate([truth.position, truth.velocity], axis=1)
    values: dict[str, Any] = {
        "header": _header(types, truth.stamp, MAP_FRAME),
        "next_stamp": _time(types, truth.next_stamp),
        "contributor_sensor": [],
    }
    for name, column in COLUMNS.items():
        if name != "state":
            values[name] = np.zeros(0, column.dtype)
    for index, name in enumerate(STATE_NAMES):
        values[name] = np.ascontiguousarray(state[:, index])
    values["id"] = truth.id
    values["status"] = np.full(count, TrackStatus.CONFIRMED, np.uint8)
    values["source"] = np.full(count, TrackSource.TRUTH, np.uint8)
    values["existence_probability"] = np.ones(count)
    return _serialised(TRACKS_TYPE, values)


def _header(types: Mapping[str, Any], stamp: int, frame: str) -> Any:
    return types["std_msgs/msg/Header"](_time(types, stamp), frame)


def _time(types: Mapping[str, Any], stamp: int) -> Any:
    return types["builtin_interfaces/msg/Time"](*divmod(stamp, NANOSECONDS))


def _pose(types: Mapping[str, Any], position: tuple[float, float], yaw: float) -> Any:
    point = types["geometry_msgs/msg/Point"](*position, 0.0)
    turn = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))
    return types["geometry_msgs/msg/Pose"](point, turn)


def _serialised(type_name: str, values: Mapping[str, Any]) -> bytes:
    store = installed_typestore(type_name)
    message = store.types[type_name](**values)
    return bytes(store.serialize_cdr(message, type_name, little_endian=True))
