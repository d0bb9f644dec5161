"""Serialised messages made without ROS, for bags that are not recorded but imported."""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.importers.array_geometry_file import RecordedArray
from sonar_tracking.bags.importers.bearing_truth_file import SurveyedBearings
from sonar_tracking.bags.storage.bag_records import (
    BEARING_TRACKS_TYPE,
    SAMPLES_TYPE,
    SNAPSHOTS_TYPE,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import Sensor, TrackStatus
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS

_CONE = 0


def snapshots_cdr(
    array: RecordedArray,
    stamp: int,
    next_stamp: int,
    data: ComplexArray,
    sample_period: float,
    frequency: float,
    bandwidth: float,
) -> bytes:
    """Return a serialised ArraySnapshots message.

    Parameters
    ----------
    array : RecordedArray
        The array.
    stamp, next_stamp : int
        First snapshot, and watermark, ns.
    data : ndarray, shape (n_snapshots, n_elements), complex
        Snapshots, linear amplitude.
    sample_period : float
        s.
    frequency, bandwidth : float
        Hz.
    """
    flat = np.ascontiguousarray(data, np.complex64).reshape(-1).view(np.float32)
    values = {
        **message_head(Sensor(array.sensor_id), stamp, next_stamp, SNAPSHOTS_TYPE),
        **_elements(array.element_positions),
        "sample_period": sample_period,
        "center_frequency": frequency,
        "bandwidth": bandwidth,
        "sound_speed": array.sound_speed,
        "n_snapshots": len(data),
        "data": flat,
        "noise_covariance": np.zeros(0),
    }
    return serialised(SNAPSHOTS_TYPE, values)


def samples_cdr(block: ArraySamples) -> bytes:
    """Return a serialised ArraySamples message (data rounded to float32)."""
    values = {
        **message_head(block.sensor, block.stamp, block.next_stamp, SAMPLES_TYPE),
        **_elements(block.element_positions),
        "sample_rate": block.sample_rate,
        "sound_speed": block.sound_speed,
        "n_samples": len(block.data),
        "data": np.ascontiguousarray(block.data, np.float32).reshape(-1),
    }
    return serialised(SAMPLES_TYPE, values)


def truth_cdr(array: RecordedArray, stamp: int, next_stamp: int, truth: SurveyedBearings) -> bytes:
    """Return serialised true bearings (a BearingTracks message)."""
    count = len(truth.target)
    unknown = np.full(count, np.nan)
    values = {
        **message_head(Sensor(array.sensor_id), stamp, next_stamp, BEARING_TRACKS_TYPE),
        "angle_kind": _CONE,
        "id": truth.target,
        "status": np.full(count, TrackStatus.CONFIRMED, np.uint8),
        "arrival_angle": truth.angle,
        "arrival_angle_rate": truth.rate,
        "covariance": np.zeros(4 * count),
        "measurement": unknown,
        "measurement_variance": unknown,
        "innovation": unknown,
        "signal_to_noise_ratio": unknown,
        "existence_probability": np.ones(count),
        "ambiguous": np.ones(count, np.bool_),
        "elevation": np.zeros(0),
        "elevation_variance": np.zeros(0),
    }
    return serialised(BEARING_TRACKS_TYPE, values)


def message_head(sensor: Sensor, stamp: int, next_stamp: int, type_name: str) -> dict[str, Any]:
    """Return what every message of a sensor begins with."""
    types = installed_typestore(type_name).types
    point = types["geometry_msgs/msg/Point"](*sensor.position)
    turn = types["geometry_msgs/msg/Quaternion"](*sensor.orientation)
    return {
        "header": types["std_msgs/msg/Header"](_time(types, stamp), sensor.frame_id),
        "next_stamp": _time(types, next_stamp),
        "sensor_id": sensor.sensor_id,
        "sensor_pose": types["geometry_msgs/msg/Pose"](point, turn),
        "sensor_velocity": types["geometry_msgs/msg/Vector3"](*sensor.velocity),
    }


def _elements(positions: FloatArray) -> dict[str, FloatArray]:
    columns = np.ascontiguousarray(positions.T)
    return dict(zip(("element_x", "element_y", "element_z"), columns, strict=True))


def _time(types: dict[str, Any], stamp: int) -> Any:
    seconds, nanoseconds = divmod(stamp, NANOSECONDS)
    return types["builtin_interfaces/msg/Time"](seconds, nanoseconds)


def serialised(type_name: str, values: dict[str, Any]) -> bytes:
    """Return a message of a type as the middleware serialises it."""
    store = installed_typestore(type_name)
    message = store.types[type_name](**values)
    return bytes(store.serialize_cdr(message, type_name, little_endian=True))
