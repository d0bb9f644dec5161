"""Fields of messages to and from numpy: stamps, columns, complex matrices, sensors.

Building blocks of :mod:`sonar_tracking.graph.conversions`. Columns go through ``array.array`` on
publish (assigning an ndarray to a message field converts element by element, a hundred times
slower) and are viewed without a copy on receive.
"""

from __future__ import annotations

import array
import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from numpy.typing import NDArray

from sonar_tracking.errors import InputError
from sonar_tracking.passive.records import Sensor

NANOSECONDS = 1_000_000_000

_TYPE_CODES = {"float64": "d", "float32": "f", "uint64": "Q", "uint32": "I", "uint8": "B"}


def stamp_from_time(time: Time) -> int:
    """Return a time message as integer nanoseconds."""
    return int(time.sec) * NANOSECONDS + int(time.nanosec)


def time_from_stamp(stamp: int) -> Time:
    """Return integer nanoseconds as a time message."""
    seconds, nanoseconds = divmod(int(stamp), NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def type_name(message: Any) -> str:
    """Return the short name of a message's type, as errors name it."""
    return type(message).__name__


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


def column(message: Any, name: str, dtype: str = "float64") -> NDArray[Any]:
    """Return a message field as a flat array (a view of the message, not a copy)."""
    values = getattr(message, name)
    if len(values) == 0:
        return np.empty(0, dtype)
    if isinstance(values, array.array | bytes):
        return np.frombuffer(values, dtype)
    return np.asarray(values, dtype)


def complex_column(
    message: Any, name: str, shape: tuple[int, ...], meaning: str, dtype: str = "float64"
) -> NDArray[np.complex128]:
    """Return an interleaved (re, im) field as a complex array of the given shape.

    Raises
    ------
    InputError
        When the number of values is not that of the shape; ``meaning`` says in words what the
        shape is, e.g. ``"n_snapshots x elements"``.
    """
    values = column(message, name, dtype)
    expected = 2 * int(np.prod(shape))
    if values.size != expected:
        sizes = " x ".join(str(size) for size in shape)
        raise InputError(
            f"{type_name(message)}.{name} has {values.size} values, but {meaning} = {sizes} "
            f"complex numbers need {expected}; the sender must make them agree."
        )
    complex_type = np.complex64 if dtype == "float32" else np.complex128
    return values.view(complex_type).reshape(shape).astype(np.complex128)


def check_columns(message: Any, key: str, widths: dict[str, int]) -> int:
    """Check that all columns of a message have equal length or are empty.

    Parameters
    ----------
    message : message
        Message to check, before it is published or after it was received.
    key : str
        Column that is never empty unless all are, e.g. ``"id"``.
    widths : dict of str to int
        Values per row of every other column.

    Returns
    -------
    int
        Number of rows.

    Raises
    ------
    InputError
        Naming message, field and both lengths.
    """
    rows = len(getattr(message, key))
    for name, width in widths.items():
        length = len(getattr(message, name))
        if length not in (0, width * rows):
            raise InputError(
                f"{type_name(message)}.{name} has {length} values, but {key} has {rows} and "
                f"{name} needs {width * rows} or none; the sender must make them agree."
            )
    return rows


def element_positions(message: Any) -> NDArray[np.float64]:
    """Return element_x, element_y and element_z as one array, shape (n_elements, 3), m.

    Raises
    ------
    InputError
        When the three have different lengths.
    """
    if not len(message.element_x) == len(message.element_y) == len(message.element_z):
        raise InputError(
            f"{type_name(message)}.element_x, element_y and element_z have "
            f"{len(message.element_x)}, {len(message.element_y)} and {len(message.element_z)} "
            "values; the sender must give one position per element."
        )
    return np.stack([column(message, f"element_{axis}") for axis in "xyz"], axis=-1)


def set_element_positions(message: Any, positions: NDArray[np.float64]) -> None:
    """Set element_x, element_y and element_z from an array of shape (n_elements, 3), m."""
    for index, axis in enumerate("xyz"):
        setattr(message, f"element_{axis}", packed(positions[:, index]))


def sensor(message: Any) -> Sensor:
    """Return the sensor of a message."""
    position, orientation = message.sensor_pose.position, message.sensor_pose.orientation
    velocity = message.sensor_velocity
    return Sensor(
        sensor_id=message.sensor_id,
        frame_id=message.header.frame_id,
        position=(position.x, position.y, position.z),
        orientation=(orientation.x, orientation.y, orientation.z, orientation.w),
        velocity=(velocity.x, velocity.y, velocity.z),
    )


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
