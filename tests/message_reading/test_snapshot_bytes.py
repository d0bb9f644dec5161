"""Blocks read from bytes are those read from messages, whatever the block before was."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sonar_tracking_msgs.msg import ArraySnapshots as Message

from sonar_tracking.graph.message_writing.array_writing import snapshots_to_message
from sonar_tracking.graph.message_writing.simulated_writing import snapshots_to_bytes
from sonar_tracking.message_reading.array_reading import snapshots_from_message
from sonar_tracking.message_reading.snapshot_bytes import SnapshotBytes
from sonar_tracking.records.bearings import ArraySnapshots, Sensor


def block(stamp: int = 5, rows: int = 4, **changes: Any) -> ArraySnapshots:
    """Return a block of three elements whose data depend on its stamp."""
    data = np.exp(1j * (stamp + np.arange(3 * rows).reshape(rows, 3)))
    positions = np.arange(9.0).reshape(3, 3)
    record = ArraySnapshots(stamp, data, positions, 0.1, 1e3, 10.0, 1500.0, None, stamp + 7)
    return dataclasses.replace(record, **changes)


def assert_same(found: ArraySnapshots, expected: ArraySnapshots) -> None:
    for field in dataclasses.fields(expected):
        one, other = getattr(found, field.name), getattr(expected, field.name)
        if isinstance(other, Sensor):
            one, other = dataclasses.astuple(one), dataclasses.astuple(other)
        np.testing.assert_equal(one, other, err_msg=field.name)
    assert found.data.dtype == expected.data.dtype


CHANGES: list[dict[str, Any]] = [
    {},
    {"rows": 5},
    {"center_frequency": 1.5e3},
    {"element_positions": np.arange(1.0, 10.0).reshape(3, 3)},
    {"noise_covariance": np.eye(3, dtype=complex)},
    {"sensor": Sensor("other", "own_ship/other", (1.0, 2.0, 3.0), (0.0, 0.0, 1.0, 0.0))},
    {"next_stamp": 2**60},
    {"data": np.full((4, 3), np.nan, complex)},
]


@pytest.mark.slow
@given(st.lists(st.sampled_from(CHANGES), min_size=2, max_size=6))
def test_a_block_is_read_the_same_whatever_came_before(changes: list[dict[str, Any]]) -> None:
    reader = SnapshotBytes()
    for number, change in enumerate(changes):
        data = snapshots_to_bytes(block(10**9 * (number + 1) + 3, **change))
        expected = snapshots_from_message(deserialize_message(data, Message))
        found = reader.record(data)
        alike = number > 0 and changes[number - 1] is change
        assert (found is not None) == (alike or _differ_in_data_alone(changes, number))
        if found is None:
            reader.learn(data, expected)
        else:
            assert_same(found, expected)


def _differ_in_data_alone(changes: list[dict[str, Any]], number: int) -> bool:
    """Tell whether the last block that was read as a message differs in stamps and data alone."""

    def rest(change: dict[str, Any]) -> list[str]:
        return [name for name in change if name not in ("data", "next_stamp")]

    return number > 0 and not rest(changes[number]) and not rest(changes[number - 1])


@pytest.mark.parametrize("value", [1e20, -1e20, math.inf])
def test_data_that_may_be_refused_are_read_as_a_message(value: float) -> None:
    reader = SnapshotBytes()
    good = block()
    reader.learn(snapshots_to_bytes(good), good)
    data = good.data.copy()
    data[1, 2] = value
    assert reader.record(snapshots_to_bytes(block(6, data=data))) is None
    assert reader.record(snapshots_to_bytes(block(6))) is not None


def test_what_ros_writes_is_read_too() -> None:
    reader = SnapshotBytes()
    first = serialize_message(snapshots_to_message(block()))
    reader.learn(first, snapshots_from_message(deserialize_message(first, Message)))
    second = serialize_message(snapshots_to_message(block(8)))
    found = reader.record(second[:5] + second[5:])
    assert found is None or found.stamp == 8


def test_bytes_that_are_no_block_are_not_learnt() -> None:
    reader = SnapshotBytes()
    for data in (b"", b"\0\1\0\0", b"\0\1\0\0" + b"\xff" * 60):
        reader.learn(data, block())
        assert reader.record(data) is None
