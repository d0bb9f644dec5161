"""What a stage gives is what the next one gets: exact round trips, and no malformed message."""

from __future__ import annotations

import array
import dataclasses
import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from rclpy.serialization import deserialize_message, serialize_message

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.message_reading import array_reading
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks, Sensor, SubspaceEstimates
from sonar_tracking.records.own_ship import OwnShipState

plain = st.floats(-1000.0, 1000.0)
"""Within what any field can hold."""
reals = plain | st.sampled_from([math.nan, math.inf, -math.inf])
told = reals.filter(bool)
"""Numbers that cannot be zero: a zero says that they are unknown."""
required = plain.filter(bool)
turns = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda turn: max(map(abs, turn)) >= 0.25)
stamps = st.integers(1, 2**31 * 10**9 - 1)
sizes = st.integers(1, 5)


@cache
def columns(
    shape: tuple[int, ...], elements: st.SearchStrategy[float]
) -> st.SearchStrategy[np.ndarray]:
    """Return a strategy that is checked once, not at every draw."""
    return arrays.arrays(np.float64, shape, elements=elements)


def floats(draw: st.DrawFn, *shape: int, elements: st.SearchStrategy[float] = reals) -> np.ndarray:
    return draw(columns(shape, elements))


def positions(draw: st.DrawFn, elements: int) -> np.ndarray:
    """Of elements that are not all at one place."""
    placed = floats(draw, elements, 3)
    assume(elements == 1 or placed.any())
    return placed


def complexes(draw: st.DrawFn, *shape: int) -> np.ndarray:
    return floats(draw, *shape, 2).view(np.complex128).reshape(shape)


@st.composite
def sensors(draw: st.DrawFn) -> Sensor:
    numbers = [draw(reals) for _ in range(6)]
    orientation = draw(turns | st.just((math.nan,) * 4))
    # A place that is unknown beside a turn that nobody has set tells no turn.
    assume(all(map(math.isfinite, numbers[:2])) or any(orientation[:3]))
    return Sensor(
        sensor_id=draw(st.text("abc/_7", max_size=8)),
        frame_id="own_ship/array",
        position=tuple(numbers[:3]),  # type: ignore[arg-type]
        orientation=orientation,
        velocity=tuple(numbers[3:]),  # type: ignore[arg-type]
    )


@st.composite
def snapshots(draw: st.DrawFn) -> ArraySnapshots:
    elements = draw(sizes)
    data = draw(
        arrays.arrays(
            np.float32,
            (draw(st.integers(1, 4)), elements, 2),
            elements=st.floats(-1024.0, 1024.0, width=32),
        )
    )
    return ArraySnapshots(
        stamp=draw(stamps),
        data=data.view(np.complex64)[..., 0].astype(np.complex128),
        element_positions=positions(draw, elements),
        sample_period=draw(st.floats(1e-6, 10.0)),
        center_frequency=draw(required),
        bandwidth=draw(reals),
        sound_speed=draw(required),
        noise_covariance=complexes(draw, elements, elements) if draw(st.booleans()) else None,
        next_stamp=draw(stamps),
        sensor=draw(sensors()),
    )


@st.composite
def subspaces(draw: st.DrawFn) -> SubspaceEstimates:
    elements, count, columns = draw(sizes), draw(st.integers(0, 3)), draw(st.integers(0, 3))
    known = draw(st.booleans())
    return SubspaceEstimates(
        stamp=draw(stamps),
        method=draw(st.sampled_from(["past", "covariance"])),
        basis=complexes(draw, count, elements, columns),
        time_offsets=floats(draw, count),
        element_positions=positions(draw, elements),
        sample_period=draw(required),
        center_frequency=draw(required),
        bandwidth=draw(reals),
        sound_speed=draw(required),
        effective_snapshots=draw(required),
        rank=draw(st.integers(-1, 9)) if known else -1,
        source_count=draw(st.integers(-1, 9)) if known else -1,
        covariance=complexes(draw, elements, elements) if known else None,
        covariance_snapshots=draw(st.integers(1, 1000)) if known else 0,
        covariance_time_offset=draw(plain) if known else np.nan,
        eigenvalues=floats(draw, elements) if known else np.empty(0),
        noise_power=np.array(draw(told)),
        noise_covariance=complexes(draw, elements, elements) if known else None,
        next_stamp=draw(stamps),
        sensor=draw(sensors()),
    )


@st.composite
def bearing_tracks(draw: st.DrawFn, min_tracks: int = 0) -> BearingTracks:
    rows = draw(st.integers(min_tracks, 4))
    return BearingTracks(
        stamp=draw(stamps),
        id=draw(arrays.arrays(np.uint64, rows)),
        status=draw(arrays.arrays(np.uint8, rows)),
        arrival_angle=floats(draw, rows),
        arrival_angle_rate=floats(draw, rows),
        covariance=floats(draw, rows, 2, 2),
        measurement=floats(draw, rows),
        measurement_variance=floats(draw, rows, elements=told),
        innovation=floats(draw, rows),
        signal_to_noise_ratio=floats(draw, rows, elements=told),
        existence_probability=floats(draw, rows),
        ambiguous=draw(arrays.arrays(np.bool_, rows)),
        next_stamp=draw(stamps),
        sensor=draw(sensors()),
    )


def through_the_wire(message: Any) -> Any:
    return deserialize_message(serialize_message(message), type(message))


def assert_same(found: Any, expected: Any) -> None:
    """Equal bit for bit, NaN included."""
    for field in dataclasses.fields(expected):
        one, other = getattr(found, field.name), getattr(expected, field.name)
        if dataclasses.is_dataclass(other):
            assert_same(one, other)
        elif isinstance(other, np.ndarray):
            assert one.dtype == other.dtype and one.shape == other.shape, field.name
            np.testing.assert_array_equal(one, other, err_msg=field.name)
        else:
            np.testing.assert_equal(one, other, err_msg=field.name)


@pytest.mark.slow
@given(snapshots())
def test_snapshots_round_trip(record: ArraySnapshots) -> None:
    message = through_the_wire(array_writing.snapshots_to_message(record))
    assert_same(array_reading.snapshots_from_message(message), record)


@pytest.mark.slow
@given(subspaces())
def test_subspaces_round_trip(record: SubspaceEstimates) -> None:
    message = through_the_wire(array_writing.subspaces_to_message(record))
    assert_same(array_reading.subspaces_from_message(message), record)


@pytest.mark.slow
@given(bearing_tracks())
def test_bearing_tracks_round_trip(record: BearingTracks) -> None:
    message = through_the_wire(array_writing.bearing_tracks_to_message(record))
    assert_same(array_reading.bearing_tracks_from_message(message), record)


@given(st.floats(-math.pi, math.pi), st.floats(-1e6, 1e6), st.floats(-30.0, 30.0))
def test_own_ship_round_trip(yaw: float, coordinate: float, speed: float) -> None:
    record = OwnShipState(7, (coordinate, -coordinate), yaw, (speed, 0.1), 0.01)
    found = array_reading.own_ship_from_message(
        through_the_wire(array_writing.own_ship_to_message(record))
    )
    assert math.remainder(found.yaw - yaw, 2 * math.pi) == pytest.approx(0.0, abs=1e-12)
    assert dataclasses.replace(found, yaw=yaw) == record


def test_odometry_without_an_orientation_is_refused() -> None:
    message = array_writing.own_ship_to_message(OwnShipState(7, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0))
    message.pose.pose.orientation.w = 0.0
    with pytest.raises(InputError, match="orientation of length zero"):
        array_reading.own_ship_from_message(message)


def good_snapshots() -> Any:
    record = ArraySnapshots(5, np.ones((2, 3), complex), np.eye(3), 0.1, 1e3, 10.0, 1500.0)
    return array_writing.snapshots_to_message(record)


def test_a_wrong_element_count_is_named() -> None:
    message = good_snapshots()
    message.data = array.array("f", [0.0] * 10)
    with pytest.raises(InputError, match=r"ArraySnapshots\.data has 10 values.*2 x 3.*need 12"):
        array_reading.snapshots_from_message(message)


def test_element_coordinates_of_unequal_length_are_named() -> None:
    message = good_snapshots()
    message.element_y = array.array("d", [0.0])
    with pytest.raises(InputError, match="element_x, element_y and element_z have 3, 1 and 3"):
        array_reading.snapshots_from_message(message)


@pytest.mark.slow
@given(bearing_tracks(min_tracks=1), st.sampled_from(["covariance", "arrival_angle", "elevation"]))
def test_columns_of_unequal_length_are_refused_both_ways(record: BearingTracks, name: str) -> None:
    message = array_writing.bearing_tracks_to_message(record)
    getattr(message, name).extend([0.0] * 5)
    with pytest.raises(InputError, match=rf"BearingTracks\.{name} has \d+ values, but id has"):
        array_reading.bearing_tracks_from_message(message)
    longer = dataclasses.replace(record, arrival_angle=np.zeros(len(record.id) + 1))
    with pytest.raises(InputError, match=r"BearingTracks\.arrival_angle"):
        array_writing.bearing_tracks_to_message(longer)


def test_empty_columns_mean_unknown() -> None:
    message = array_writing.bearing_tracks_to_message(array_writing.NO_BEARING_TRACKS)
    message.id = array.array("Q", [4, 5])
    record = array_reading.bearing_tracks_from_message(message)
    assert np.isnan(record.arrival_angle).all() and record.arrival_angle.shape == (2,)
    assert record.covariance.shape == (2, 2, 2)


def test_azimuth_tracks_are_not_taken_for_cone_angles() -> None:
    message = array_writing.bearing_tracks_to_message(array_writing.NO_BEARING_TRACKS)
    message.angle_kind = message.AZIMUTH
    with pytest.raises(InputError, match="angle_kind is 1"):
        array_reading.bearing_tracks_from_message(message)


def test_fields_agree_with_their_types() -> None:
    """Field checks are off by default; with them on every constructor argument is verified."""
    record = subspaces_example()
    message = array_writing.subspaces_to_message(record)
    fields = {name: getattr(message, name) for name in message.get_fields_and_field_types()}
    type(message)(check_fields=True, **fields)


def subspaces_example() -> SubspaceEstimates:
    return SubspaceEstimates(
        stamp=5,
        method="past",
        basis=np.ones((2, 3, 1), complex),
        time_offsets=np.array([-0.1, 0.1]),
        element_positions=np.eye(3),
        sample_period=0.1,
        center_frequency=1e3,
        bandwidth=10.0,
        sound_speed=1500.0,
        effective_snapshots=39.0,
    )


def test_a_subspace_without_its_time_is_refused() -> None:
    message = array_writing.subspaces_to_message(subspaces_example())
    message.time_offsets = array.array("d", [0.0])
    with pytest.raises(InputError, match="time_offsets has 1 values, but n_subspaces is 2"):
        array_reading.subspaces_from_message(message)
