"""Messages that are written as bytes are those that ROS would write, and checked alike."""

from __future__ import annotations

import dataclasses
import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from rclpy.serialization import deserialize_message, serialize_message

from sonar_tracking.bags.contents.digest import canonical_cdr, installed_typestore
from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing import array_writing, position_writing, simulated_writing
from sonar_tracking.message_reading.identifier_reading import (
    bearing_identifiers,
    position_identifiers,
)
from sonar_tracking.records.bearings import AngleKind, ArraySnapshots, BearingTracks, Sensor
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks

reals = st.floats(-1e9, 1e9) | st.sampled_from([math.nan, math.inf])
stamps = st.integers(0, 2**31 * 10**9 - 1)
angles = st.floats(-math.pi, math.pi)
pairs = st.tuples(reals, reals)
own_ships = st.builds(OwnShipState, stamps, pairs, angles, pairs, reals)
words = st.text("abc/_é", max_size=9)


@cache
def columns(
    shape: tuple[int, ...], elements: st.SearchStrategy[float]
) -> st.SearchStrategy[np.ndarray]:
    """Return a strategy that is checked once, not at every draw."""
    return arrays.arrays(np.float64, shape, elements=elements)


def floats(draw: st.DrawFn, *shape: int) -> np.ndarray:
    return draw(columns(shape, reals))


@st.composite
def sensors(draw: st.DrawFn) -> Sensor:
    numbers = [draw(reals) for _ in range(10)]
    return Sensor(
        draw(words),
        draw(words),
        tuple(numbers[:3]),  # type: ignore[arg-type]
        tuple(numbers[3:7]),  # type: ignore[arg-type]
        tuple(numbers[7:]),  # type: ignore[arg-type]
    )


@st.composite
def snapshots(draw: st.DrawFn) -> ArraySnapshots:
    rows, elements = draw(st.integers(0, 4)), draw(st.integers(1, 5))
    noise = floats(draw, elements, elements, 2).view(complex)[..., 0]
    return ArraySnapshots(
        stamp=draw(stamps),
        data=np.full((rows, elements), complex(draw(st.floats(-1e9, 1e9)), 0.25)),
        element_positions=floats(draw, elements, 3),
        sample_period=draw(reals),
        center_frequency=draw(reals),
        bandwidth=draw(reals),
        sound_speed=draw(reals),
        noise_covariance=draw(st.sampled_from([None, noise])),
        next_stamp=draw(stamps),
        sensor=draw(sensors()),
    )


@st.composite
def bearing_tracks(draw: st.DrawFn) -> BearingTracks:
    rows = draw(st.integers(0, 4))
    reported = draw(st.booleans())
    return BearingTracks(
        stamp=draw(stamps),
        id=np.arange(7, 7 + rows, dtype=np.uint64),
        status=np.full(rows, 2, np.uint8),
        arrival_angle=floats(draw, rows),
        arrival_angle_rate=floats(draw, rows),
        covariance=floats(draw, rows, 2, 2),
        measurement=floats(draw, rows),
        measurement_variance=floats(draw, rows),
        innovation=floats(draw, rows),
        signal_to_noise_ratio=floats(draw, rows),
        existence_probability=floats(draw, rows),
        ambiguous=np.arange(rows) % 2 == 0,
        elevation=floats(draw, rows if reported else 0),
        elevation_variance=floats(draw, rows if reported else 0),
        next_stamp=draw(stamps),
        sensor=draw(sensors()),
        angle_kind=draw(st.sampled_from(AngleKind)),
    )


@st.composite
def truth_tracks(draw: st.DrawFn) -> TruthTracks:
    rows = draw(st.integers(0, 4))
    identifiers = np.arange(2**40, 2**40 + rows, dtype=np.uint64)
    positions, velocities = floats(draw, rows, 2), floats(draw, rows, 2)
    return TruthTracks(draw(stamps), identifiers, positions, velocities, draw(stamps))


def assert_what_ros_writes(data: bytes, message: Any) -> None:
    """Compare with the message as ROS serialises it, without its padding and what it appends."""
    written = serialize_message(message)
    assert len(serialize_message(deserialize_message(data, type(message)))) == len(written)
    package = type(message).__module__.partition(".")[0]
    type_name = f"{package}/msg/{type(message).__name__}"
    store = installed_typestore(type_name)
    assert bytes(canonical_cdr(store, type_name, written[: len(data)])) == data


@pytest.mark.slow
@given(snapshots())
def test_snapshots(record: ArraySnapshots) -> None:
    data = simulated_writing.snapshots_to_bytes(record)
    assert_what_ros_writes(data, array_writing.snapshots_to_message(record))


@pytest.mark.slow
@given(bearing_tracks())
def test_bearing_tracks(record: BearingTracks) -> None:
    data = simulated_writing.bearing_tracks_to_bytes(record)
    assert_what_ros_writes(data, array_writing.bearing_tracks_to_message(record))
    np.testing.assert_array_equal(bearing_identifiers(data), record.id)


@pytest.mark.slow
@given(truth_tracks())
def test_truth_tracks(record: TruthTracks) -> None:
    data = simulated_writing.truth_tracks_to_bytes(record)
    assert_what_ros_writes(data, position_writing.truth_tracks_to_message(record))
    np.testing.assert_array_equal(position_identifiers(data), record.id)


@pytest.mark.slow
@given(own_ships)
def test_own_ship(record: OwnShipState) -> None:
    data = simulated_writing.own_ship_to_bytes(record)
    assert_what_ros_writes(data, array_writing.own_ship_to_message(record))


def test_columns_of_unequal_length_are_refused() -> None:
    record = dataclasses.replace(array_writing.NO_BEARING_TRACKS, arrival_angle=np.zeros(1))
    with pytest.raises(InputError, match=r"BearingTracks\.arrival_angle has 1 values, but id has"):
        simulated_writing.bearing_tracks_to_bytes(record)
    block = ArraySnapshots(5, np.ones((2, 4), complex), np.eye(3), 0.1, 1e3, 10.0, 1500.0)
    with pytest.raises(InputError, match="there are 3 elements"):
        simulated_writing.snapshots_to_bytes(block)


@pytest.mark.parametrize("read", [bearing_identifiers, position_identifiers])
def test_identifiers_of_bytes_that_are_no_message_are_refused(read: Any) -> None:
    with pytest.raises(InputError, match="bytes are no list of"):
        read(b"\0\1\0\0" + b"\xff" * 40)
    with pytest.raises(InputError, match="bytes are no list of"):
        read(b"\0")
