"""Snapshots and bearing tracks of a bag as the records the stages use, without ROS."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.bags.digest import decoded_message
from sonar_tracking.bags.message_definitions import typestore_of
from sonar_tracking.bags.reader import Bag
from sonar_tracking.errors import InputError
from sonar_tracking.passive.records import ArraySnapshots, BearingTracks, Sensor

SNAPSHOTS_TYPE = "sonar_tracking_msgs/msg/ArraySnapshots"
BEARING_TRACKS_TYPE = "sonar_tracking_msgs/msg/BearingTracks"

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


def snapshots_of(bag: Bag, topic: str) -> Iterator[ArraySnapshots]:
    """Yield the blocks of a topic in log order.

    Raises
    ------
    InputError
        If a message does not hold what it says.
    """
    for message in _decoded(bag, topic):
        positions = np.stack([message.element_x, message.element_y, message.element_z], axis=-1)
        n_elements = len(positions)
        data = message.data.view(np.complex64)
        if data.size != message.n_snapshots * n_elements:
            raise InputError(
                f"{topic} has a block of {data.size} values for {message.n_snapshots} snapshots "
                f"of {n_elements} elements; the sender must make them agree."
            )
        noise = message.noise_covariance.view(np.complex128)
        yield ArraySnapshots(
            stamp=_stamp(message.header.stamp),
            data=data.reshape(-1, n_elements).astype(np.complex128),
            element_positions=positions,
            sample_period=message.sample_period,
            center_frequency=message.center_frequency,
            bandwidth=message.bandwidth,
            sound_speed=message.sound_speed,
            noise_covariance=noise.reshape(n_elements, n_elements) if noise.size else None,
            next_stamp=_stamp(message.next_stamp),
            sensor=_sensor(message),
        )


def bearing_tracks_of(bag: Bag, topic: str) -> Iterator[BearingTracks]:
    """Yield the track lists of a topic in log order; a column not reported is NaN.

    Raises
    ------
    InputError
        If the columns of a message do not fit together.
    """
    for message in _decoded(bag, topic):
        rows = len(message.id)
        reals = {name: _column(message, topic, name, rows) for name in _TRACK_REALS}
        yield BearingTracks(
            stamp=_stamp(message.header.stamp),
            id=message.id,
            status=_column(message, topic, "status", rows).astype(np.uint8),
            covariance=_column(message, topic, "covariance", 4 * rows).reshape(rows, 2, 2),
            ambiguous=_column(message, topic, "ambiguous", rows).astype(np.bool_),
            next_stamp=_stamp(message.next_stamp),
            sensor=_sensor(message),
            **reals,
        )


def _decoded(bag: Bag, topic: str) -> Iterator[Any]:
    store = typestore_of(bag.topics[topic].definition)
    for message in bag.messages([topic]):
        yield decoded_message(store, bag.topics[topic].type_name, message.data)


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
