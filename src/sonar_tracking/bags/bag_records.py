"""Snapshots and bearing tracks of a bag as the records the stages use, without ROS."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.bags.digest import decoded_message
from sonar_tracking.bags.message_definitions import typestore_of
from sonar_tracking.bags.reader import Bag
from sonar_tracking.errors import InputError
from sonar_tracking.passive.records import ArraySnapshots, BearingTracks, Sensor

SNAPSHOTS_TYPE = "sonar_tracking_msgs/msg/ArraySnapshots"
BEARING_TRACKS_TYPE = "sonar_tracking_msgs/msg/BearingTracks"

Record = TypeVar("Record")

_NANOSECONDS = 1_000_000_000
_TRACK_REALS = (
    "arrival_angle",
    "arrival_angle_rate",
    "measurement",
    "measurement_variance",
    "innovation",
    "signal_to_noise_ratio",
    "existence_probability",
)


def topics_of_type(bag: Bag, type_name: str, role: str = "") -> list[str]:
    """Return the topics of a type that hold messages; of one role if it is given."""
    return [
        name
        for name, topic in bag.topics.items()
        if topic.type_name == type_name and topic.message_count and role in ("", topic.role)
    ]


def snapshots_of(
    bag: Bag, topic: str, rejected: list[str] | None = None
) -> Iterator[ArraySnapshots]:
    """Yield the blocks of a topic in log order.

    Parameters
    ----------
    bag : Bag
        The bag.
    topic : str
        A topic of :data:`SNAPSHOTS_TYPE`.
    rejected : list of str, optional
        Takes a sentence for each message that does not hold what it says, which is then left out;
        without it such a message raises.

    Raises
    ------
    InputError
        If a message does not hold what it says.
    """
    yield from _converted(bag, topic, _snapshots, rejected)


def bearing_tracks_of(
    bag: Bag, topic: str, rejected: list[str] | None = None
) -> Iterator[BearingTracks]:
    """Yield the track lists of a topic in log order; a column not reported is NaN.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, _bearing_tracks, rejected)


def _converted(
    bag: Bag, topic: str, convert: Callable[[Any, str], Record], rejected: list[str] | None
) -> Iterator[Record]:
    store = typestore_of(bag.topics[topic].definition)
    for message in bag.messages([topic]):
        try:
            decoded = decoded_message(store, bag.topics[topic].type_name, message.data)
            yield convert(decoded, topic)
        except InputError as error:
            if rejected is None:
                raise
            rejected.append(str(error))


def _snapshots(message: Any, topic: str) -> ArraySnapshots:
    n_elements = len(message.element_x)
    n_reals, n_noise_reals = message.data.size, message.noise_covariance.size
    if n_reals != 2 * message.n_snapshots * n_elements or not n_elements:
        raise InputError(
            f"{topic} has a block of {n_reals} reals for {message.n_snapshots} snapshots of "
            f"{n_elements} elements; the sender must make them agree."
        )
    if n_noise_reals not in (0, 2 * n_elements**2):
        raise InputError(
            f"{topic} has a noise covariance of {n_noise_reals} reals for {n_elements} elements; "
            "the sender must make them agree."
        )
    data, noise = message.data.view(np.complex64), message.noise_covariance.view(np.complex128)
    columns = [_column(message, topic, f"element_{axis}", n_elements) for axis in "xyz"]
    return ArraySnapshots(
        stamp=_stamp(message.header.stamp),
        data=data.reshape(-1, n_elements).astype(np.complex128),
        element_positions=np.stack(columns, axis=-1),
        sample_period=message.sample_period,
        center_frequency=message.center_frequency,
        bandwidth=message.bandwidth,
        sound_speed=message.sound_speed,
        noise_covariance=noise.reshape(n_elements, n_elements) if noise.size else None,
        next_stamp=_stamp(message.next_stamp),
        sensor=_sensor(message),
    )


def _bearing_tracks(message: Any, topic: str) -> BearingTracks:
    rows = len(message.id)
    reals = {name: _column(message, topic, name, rows) for name in _TRACK_REALS}
    return BearingTracks(
        stamp=_stamp(message.header.stamp),
        id=message.id,
        status=_column(message, topic, "status", rows).astype(np.uint8),
        covariance=_column(message, topic, "covariance", 4 * rows).reshape(rows, 2, 2),
        ambiguous=_column(message, topic, "ambiguous", rows).astype(np.bool_),
        next_stamp=_stamp(message.next_stamp),
        sensor=_sensor(message),
        **reals,
    )


def _column(message: Any, topic: str, name: str, length: int) -> NDArray[Any]:
    values = np.asarray(getattr(message, name))
    if values.size == length:
        return values
    if values.size:
        raise InputError(
            f"{topic} has {values.size} values of {name} where there should be {length}; the "
            "sender must make them agree."
        )
    return np.full(length, np.nan) if name in (*_TRACK_REALS, "covariance") else np.zeros(length)


def _sensor(message: Any) -> Sensor:
    position, turn = message.sensor_pose.position, message.sensor_pose.orientation
    velocity = message.sensor_velocity
    return Sensor(
        sensor_id=message.sensor_id,
        frame_id=message.header.frame_id,
        position=(position.x, position.y, position.z),
        orientation=(turn.x, turn.y, turn.z, turn.w),
        velocity=(velocity.x, velocity.y, velocity.z),
    )


def _stamp(time: Any) -> int:
    return int(time.sec) * _NANOSECONDS + int(time.nanosec)
