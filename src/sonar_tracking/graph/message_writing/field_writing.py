"""Fields of messages from numpy: stamps, columns, complex matrices, sensors.

Building blocks of :mod:`sonar_tracking.graph.message_writing.array_writing`. Columns go through
``array.array``: assigning an ndarray to a message field converts element by element, a hundred
times slower.
"""

from __future__ import annotations

import array
import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.time import NANOSECONDS

_TYPE_CODES = {"float64": "d", "float32": "f", "uint64": "Q", "uint32": "I", "uint8": "B"}


def time_from_stamp(stamp: int) -> Time:
    """Return integer nanoseconds as a time message."""
    seconds, nanoseconds = divmod(int(stamp), NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def packed(values: Any, dtype: str = "float64") -> array.array[Any]:
    """Return an array as the flat ``array.array`` of a message field (row-major, one copy)."""
    flat = np.ascontiguousarray(values, dtype=dtype)
    column: array.array[Any] = array.array(_TYPE_CODES[dtype])
    if flat.size:
        column.frombytes(flat.reshape(-1).data.cast("B"))
    return column


def packed_complex(values: Any, dtype: str = "float64") -> array.array[Any]:
    """Return a complex array as interleaved (re, im) reals of the given type."""
    complex_type = np.complex64 if dtype == "float32" else np.complex128
    flat = np.ascontiguousarray(values, dtype=complex_type)
    return packed(flat.reshape(-1).view(dtype), dtype)


def set_element_positions(message: Any, positions: FloatArray) -> None:
    """Set element_x, element_y and element_z from an array of shape (n_elements, 3), m."""
    for index, axis in enumerate("xyz"):
        setattr(message, f"element_{axis}", packed(positions[:, index]))


def set_sensor(message: Any, value: Sensor) -> None:
    """Set sensor_id, sensor_pose, sensor_velocity and the frame of a message."""
    message.sensor_id = value.sensor_id
    message.header.frame_id = value.frame_id
    set_vector(message.sensor_pose.position, value.position)
    set_quaternion(message.sensor_pose.orientation, value.orientation)
    set_vector(message.sensor_velocity, value.velocity)


def set_vector(target: Any, values: Sequence[float]) -> None:
    """Set x, y, z of a Point or Vector3 message."""
    target.x, target.y, target.z = (float(value) for value in values)


def set_quaternion(target: Any, values: Sequence[float]) -> None:
    """Set x, y, z, w of a Quaternion message."""
    target.x, target.y, target.z, target.w = (float(value) for value in values)


def set_stamps(message: Any, stamp: int, next_stamp: int) -> None:
    """Set header.stamp and next_stamp of a message, ns."""
    message.header.stamp = time_from_stamp(stamp)
    message.next_stamp = time_from_stamp(next_stamp)


def message_class(message_type: str) -> Any:
    """Return the class of a message type such as ``"nav_msgs/msg/Odometry"``."""
    package, kind, name = message_type.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)
