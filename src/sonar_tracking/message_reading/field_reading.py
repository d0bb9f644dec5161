"""Fields of messages as numpy: stamps, columns, complex matrices, sensors.

A message is any object with the fields of its definition: one that a node received, or one decoded
from a bag without ROS. Columns are viewed without a copy where they can be. What the sender has not
filled in is unknown, or an error, as :data:`~sonar_tracking.message_reading.field_use.FIELD_USES`
says.
"""

from __future__ import annotations

import array
import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.errors import InputError
from sonar_tracking.message_reading.field_limits import check_magnitude, check_size
from sonar_tracking.message_reading.field_use import FIELD_USES, FieldUse, Unfilled
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.time import LAST_STAMP, NANOSECONDS
from sonar_tracking.sensor_pose import is_no_turn, unit_sized

_REMEMBERED = 64
"""Of arrays of elements, and of poses: those of a sensor are the same in most of its messages."""


def stamp_from_time(time: Any) -> int:
    """Return a time message as integer nanoseconds, the last ones that a message can hold at most.

    A malformed time may hold four seconds of nanoseconds after the last second.
    """
    return min(int(time.sec) * NANOSECONDS + int(time.nanosec), LAST_STAMP)


def type_name(message: Any) -> str:
    """Return the short name of a message's type, as errors name it."""
    return type(message).__name__.rpartition("__")[2]


def column(message: Any, name: str, dtype: str = "float64") -> NDArray[Any]:
    """Return a message field as a flat array, shape (n_values,), in units of the message.

    It is a view of the message, not a copy; empty where the message is of a definition that has no
    such field, as in a recording of an earlier version.
    """
    values = getattr(message, name, ())
    if len(values) == 0:
        return np.empty(0, dtype)
    if isinstance(values, array.array | bytes):
        return np.frombuffer(values, dtype)
    return np.asarray(values, dtype)


def field_use(message: Any, name: str) -> FieldUse:
    """Return how a field of a message is read."""
    return FIELD_USES[type_name(message)][name]


def real(message: Any, name: str) -> float:
    """Return a number, in units of the message; NaN where it is unknown.

    Raises
    ------
    InputError
        When it is required, and was not filled in; when it is absurdly large.
    """
    number = float(getattr(message, name))
    check_magnitude(type_name(message), name, abs(number))
    if number != 0.0 and not math.isnan(number):
        return number
    use = field_use(message, name)
    if use.unfilled is Unfilled.REQUIRED:
        raise unfilled(message, name, f"is {number:g}")
    return math.nan if use.unfilled is Unfilled.UNKNOWN else number


def count(message: Any, name: str) -> int:
    """Return a number of things that there must be.

    Raises
    ------
    InputError
        When there are none, or too many.
    """
    number = int(getattr(message, name))
    if number == 0:
        raise unfilled(message, name, "is 0")
    check_size(type_name(message), name, number)
    return number


def unfilled(message: Any, name: str, words: str) -> InputError:
    """Return the error that a required field was not filled in."""
    return _unfilled(type_name(message), name, words)


def _unfilled(where: str, name: str, words: str) -> InputError:
    return InputError(
        f"{where}.{name} {words}: it was not filled in; the sender must give "
        f"{FIELD_USES[where][name].text}."
    )


def known(message: Any, name: str) -> FloatArray:
    """Return a column, shape (n_values,), in units of the message; NaN where it is unknown.

    It is empty where the message does not report it.
    """
    values = column(message, name)
    if field_use(message, name).unfilled is Unfilled.UNKNOWN and not values.all():
        return np.where(values == 0.0, np.nan, values)
    return values


def rows_or_nan(message: Any, name: str, shape: tuple[int, ...]) -> FloatArray:
    """Return a column in the given shape, in units of the message; NaN where it is unknown."""
    values = known(message, name)
    return values.reshape(shape) if values.size else np.full(shape, np.nan)


def complex_column(
    message: Any, name: str, shape: tuple[int, ...], meaning: str, dtype: str = "float64"
) -> ComplexArray:
    """Return an interleaved (re, im) field as a complex array of the given shape.

    It is in units of the message.

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
    check_largest(message, name, values)
    complex_type = np.complex64 if dtype == "float32" else np.complex128
    return values.view(complex_type).reshape(shape).astype(np.complex128)


def check_largest(message: Any, name: str, values: NDArray[Any]) -> None:
    """Check that no value of a column is absurdly large.

    Parameters
    ----------
    message : message
        For its type.
    name : str
        The field.
    values : ndarray, shape (...), real
        What it holds, in units of the message.

    Raises
    ------
    InputError
        Naming message, field and value.
    """
    _check_largest(type_name(message), name, values)


def _check_largest(where: str, name: str, values: NDArray[Any]) -> None:
    if values.size:
        largest = max(float(values.max()), -float(values.min()))
        check_magnitude(where, name, largest)


def check_vector(message: Any, name: str, vector: Any) -> None:
    """Check that no component of a vector is absurdly large.

    Raises
    ------
    InputError
        Naming message, field and value.
    """
    for component in (vector.x, vector.y, vector.z):
        check_magnitude(type_name(message), name, abs(component))


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
    check_size(type_name(message), key, rows)
    for name, width in widths.items():
        length = len(getattr(message, name, ()))
        if length not in (0, width * rows):
            raise InputError(
                f"{type_name(message)}.{name} has {length} values, but {key} has {rows} and "
                f"{name} needs {width * rows} or none; the sender must make them agree."
            )
    return rows


def element_positions(message: Any) -> FloatArray:
    """Return element_x, element_y and element_z as one array, shape (n_elements, 3), m.

    Raises
    ------
    InputError
        When the three have different lengths, or were not filled in.

    Notes
    -----
    It is read-only: the same array for all messages of a sensor whose elements do not move.
    """
    if not len(message.element_x) == len(message.element_y) == len(message.element_z):
        raise InputError(
            f"{type_name(message)}.element_x, element_y and element_z have "
            f"{len(message.element_x)}, {len(message.element_y)} and {len(message.element_z)} "
            "values; the sender must give one position per element."
        )
    columns = (column(message, f"element_{axis}").tobytes() for axis in "xyz")
    return _positions(type_name(message), *columns)


@lru_cache(maxsize=_REMEMBERED)
def _positions(where: str, x: bytes, y: bytes, z: bytes) -> FloatArray:
    if not x:
        raise _unfilled(where, "element_x", "is empty")
    positions = np.stack([np.frombuffer(axis) for axis in (x, y, z)], axis=-1)
    check_size(where, "element_x", len(positions))
    _check_largest(where, "element_x", positions)
    if len(positions) > 1 and not positions.any():
        raise _unfilled(where, "element_x", "and element_y and element_z are 0 for all elements")
    positions.flags.writeable = False
    return positions


def sensor(message: Any) -> Sensor:
    """Return the sensor of a message.

    A pose that nobody has set is passed on as it is: only who knows own ship's can tell.
    """
    pose, velocity = message.sensor_pose, message.sensor_velocity
    position, turn = pose.position, pose.orientation
    return _sensor(
        type_name(message),
        message.sensor_id,
        message.header.frame_id,
        (position.x, position.y, position.z),
        (turn.x, turn.y, turn.z, turn.w),
        (velocity.x, velocity.y, velocity.z),
    )


@lru_cache(maxsize=_REMEMBERED)
def _sensor(
    where: str,
    sensor_id: str,
    frame_id: str,
    position: tuple[float, float, float],
    turn: tuple[float, float, float, float],
    velocity: tuple[float, float, float],
) -> Sensor:
    for name, vector in (("sensor_pose.position", position), ("sensor_velocity", velocity)):
        for component in vector:
            check_magnitude(where, name, abs(component))
    return Sensor(
        sensor_id=sensor_id,
        frame_id=frame_id,
        position=position,
        orientation=_orientation(position, turn),
        velocity=velocity,
    )


def sensor_orientation(message: Any) -> tuple[float, float, float, float]:
    """Return the quaternion x, y, z, w of the sensor; NaN = unknown, as beside no position."""
    position, turn = message.sensor_pose.position, message.sensor_pose.orientation
    return _orientation((position.x, position.y, position.z), (turn.x, turn.y, turn.z, turn.w))


def _orientation(
    position: tuple[float, float, float], turn: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    orientation = unit_sized(turn)
    located = math.isfinite(position[0]) and math.isfinite(position[1])
    finite = all(map(math.isfinite, orientation))
    return orientation if finite and (located or not is_no_turn(orientation)) else (math.nan,) * 4
