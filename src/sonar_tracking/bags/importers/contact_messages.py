"""Serialised pings, odometry and position tracks made without ROS."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.message_reading.contact_reading import CONTACT_REALS, DEVIATIONS
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.message_reading.position_reading import STATE_NAMES
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import (
    COLUMNS,
    MAP_FRAME,
    PositionTracks,
    TrackSource,
    TruthTracks,
)
from sonar_tracking.records.time import NANOSECONDS

CONTACTS_TYPE = "sonar_tracking_msgs/msg/Contacts"
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
    count = len(truth.id)
    state = np.concatenate([truth.position, truth.velocity], axis=1)
    values = {name: np.zeros(0, column.dtype) for name, column in COLUMNS.items()}
    values["id"] = truth.id
    values["status"] = np.full(count, TrackStatus.CONFIRMED, np.uint8)
    values["source"] = np.full(count, TrackSource.TRUTH, np.uint8)
    values["existence_probability"] = np.ones(count)
    return _tracks_cdr(truth.stamp, truth.next_stamp, values, state)


def position_tracks_cdr(tracks: PositionTracks) -> bytes:
    """Return a serialised Tracks message; a column without a known value is left empty."""
    values = {}
    for name, column in COLUMNS.items():
        own = np.ravel(getattr(tracks, name))
        unknown = column.dtype == "float64" and not np.isfinite(own).any()
        values[name] = own[:0] if unknown else own
    sensors = list(tracks.contributor_sensor)
    return _tracks_cdr(tracks.stamp, tracks.next_stamp, values, tracks.state, sensors)


def _tracks_cdr(
    stamp: int,
    next_stamp: int,
    columns: Mapping[str, Any],
    state: FloatArray,
    sensors: Sequence[str] = (),
) -> bytes:
    """Return a serialised Tracks message of columns as it carries them."""
    types = installed_typestore(TRACKS_TYPE).types
    values: dict[str, Any] = {
        "header": _header(types, stamp, MAP_FRAME),
        "next_stamp": _time(types, next_stamp),
        "contributor_sensor": list(sensors),
    }
    values.update({n: np.ascontiguousarray(one) for n, one in columns.items() if n != "state"})
    for index, name in enumerate(STATE_NAMES):
        values[name] = np.ascontiguousarray(state[:, index])
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
