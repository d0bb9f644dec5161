"""Position tracks pass through a message unchanged, and no malformed message is understood."""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from rclpy.serialization import deserialize_message, serialize_message
from sonar_tracking_msgs.msg import Tracks

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.position_writing import (
    position_tracks_to_message,
    truth_tracks_to_message,
)
from sonar_tracking.message_reading.field_use import FIELD_USES, Unfilled
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.positions import COLUMNS, PositionTracks, TrackSource, TruthTracks

stamps = st.integers(1, 2**31 * 10**9 - 1)
told = st.floats().filter(bool)
"""Numbers that cannot be zero: a zero says that they are unknown."""


@cache
def rows_of(tracks: int) -> st.SearchStrategy[Any]:
    return st.integers(0, max(0, tracks - 1))


@cache
def filled(dtype: Any, shape: tuple[int, ...], elements: Any) -> st.SearchStrategy[np.ndarray]:
    """Return a strategy that is checked once, not at every draw."""
    return arrays.arrays(dtype, shape, elements=elements)


@st.composite
def position_tracks(draw: st.DrawFn, reported: bool = True) -> PositionTracks:
    """Tracks, lines and contributors of any content; or with the columns left out."""
    tracks, lines, contributors = (draw(st.integers(0, 4)) for _ in range(3))
    rows = {"id": tracks, "line_track": lines, "contributor_track": contributors}
    if tracks == 0 or not reported:
        rows["line_track"] = rows["contributor_track"] = 0
    columns: dict[str, Any] = {}
    for name, described in COLUMNS.items():
        shape = (rows[described.key], *described.width)
        if described.fill is not None and not reported:
            continue
        owner = name == described.key != "id"
        elements = rows_of(tracks) if owner else None
        if name in FIELD_USES["Tracks"] and FIELD_USES["Tracks"][name].unfilled is Unfilled.UNKNOWN:
            elements = told
        columns[name] = draw(filled(described.dtype, shape, elements))
    count = rows["contributor_track"]
    names = draw(st.lists(st.text("ab/_", max_size=4), min_size=count, max_size=count))
    return PositionTracks(
        stamp=draw(stamps), next_stamp=draw(stamps), contributor_sensor=tuple(names), **columns
    )


def through_the_wire(message: Any) -> Any:
    return deserialize_message(serialize_message(message), type(message))


@pytest.mark.slow
@given(position_tracks(), st.booleans())
def test_every_column_comes_back(record: PositionTracks, sent: bool) -> None:
    """Equal bit for bit, NaN included, sent or not."""
    message = position_tracks_to_message(record)
    found = position_tracks_from_message(through_the_wire(message) if sent else message)
    for field in dataclasses.fields(record):
        one, other = getattr(found, field.name), getattr(record, field.name)
        np.testing.assert_array_equal(one, other, err_msg=field.name)
        if field.name in COLUMNS:
            assert one.dtype == other.dtype and one.shape == other.shape, field.name


@given(position_tracks(reported=False))
def test_what_is_not_known_is_not_invented(record: PositionTracks) -> None:
    found = position_tracks_from_message(position_tracks_to_message(record))
    assert np.isnan(found.covariance).all() and found.covariance.shape == (len(record), 4, 4)
    assert np.isnan(found.observability).all() and np.isnan(found.initiated).all()
    assert not found.hypothesis.any() and not found.bearing_track_id.any()
    assert found.contributor_sensor == () and found.line_id.size == 0


def test_a_column_of_another_length_is_named() -> None:
    message = Tracks(id=[1, 2], x=[1.0, 2.0], y=[0.0])
    with pytest.raises(InputError, match=r"Tracks\.y has 1 values, but id has 2"):
        position_tracks_from_message(message)


def test_a_line_of_a_track_that_is_not_there_is_refused() -> None:
    message = Tracks(id=[1], line_track=[1], line_id=[4])
    with pytest.raises(InputError, match="line_track names row 1, but there are 1 tracks"):
        position_tracks_from_message(message)


def test_truth_tracks_carry_every_target() -> None:
    record = TruthTracks(
        stamp=5,
        id=np.array([3, 9], np.uint64),
        position=np.array([[1.0, 2.0], [3.0, 4.0]]),
        velocity=np.array([[5.0, 6.0], [7.0, 8.0]]),
    )
    message = through_the_wire(truth_tracks_to_message(record))
    assert list(message.id) == [3, 9]
    assert [list(message.x), list(message.y)] == [[1.0, 3.0], [2.0, 4.0]]
    assert [list(message.vx), list(message.vy)] == [[5.0, 7.0], [6.0, 8.0]]
    assert list(message.source) == [message.TRUTH] * 2
    assert message.header.frame_id == "map"
    found = position_tracks_from_message(message)
    np.testing.assert_array_equal(found.state, [[1.0, 2.0, 5.0, 6.0], [3.0, 4.0, 7.0, 8.0]])
    assert list(found.source) == [TrackSource.TRUTH] * 2
