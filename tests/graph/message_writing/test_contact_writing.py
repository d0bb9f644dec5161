"""Contacts and thresholds pass through a message unchanged, and malformed messages are named."""

from __future__ import annotations

import array
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

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.contact_writing import (
    contacts_to_message,
    thresholds_to_message,
)
from sonar_tracking.message_reading.contact_reading import (
    CONTACT_REALS,
    contacts_from_message,
    thresholds_from_message,
)
from sonar_tracking.records.contacts import Contacts, GateThresholds

reals = st.floats(-1000.0, 1000.0) | st.sampled_from([math.nan, math.inf, -math.inf])
told = reals.filter(bool)
"""Numbers that cannot be zero: a zero says that they are unknown."""
stamps = st.integers(1, 2**31 * 10**9 - 1)


@cache
def columns(
    shape: tuple[int, ...], elements: st.SearchStrategy[float]
) -> st.SearchStrategy[np.ndarray]:
    """Return a strategy that is checked once, not at every draw."""
    return arrays.arrays(np.float64, shape, elements=elements)


def floats(draw: st.DrawFn, *shape: int, elements: st.SearchStrategy[float] = reals) -> np.ndarray:
    return draw(columns(shape, elements))


@st.composite
def contacts(draw: st.DrawFn) -> Contacts:
    rows = draw(st.integers(0, 4))
    deviations = [
        draw(told) if draw(st.booleans()) or rows < 2 else floats(draw, rows, elements=told)
        for _ in range(2)
    ]
    numbers: dict[str, Any] = {name: draw(told) for name in CONTACT_REALS}
    return Contacts(
        stamp=draw(stamps),
        range=floats(draw, rows),
        azimuth=floats(draw, rows),
        amplitude=floats(draw, rows) if draw(st.booleans()) else np.empty(0),
        range_standard_deviation=deviations[0],
        azimuth_standard_deviation=deviations[1],
        sensor_position=(draw(reals), draw(reals)),
        sensor_velocity=(draw(reals), draw(reals)),
        signal_to_noise_ratio_linear=draw(told),
        next_stamp=draw(stamps),
        sensor_id=draw(st.text("abc/_7", max_size=8)),
        frame_id=draw(st.sampled_from(["map", "own_ship/base_link"])),
        **numbers,
    )


@st.composite
def thresholds(draw: st.DrawFn) -> GateThresholds:
    rows = draw(st.integers(0, 4))
    return GateThresholds(
        stamp=draw(stamps),
        track_id=draw(arrays.arrays(np.int64, rows, elements=st.integers(0, 2**62))),
        false_alarm_probability=floats(draw, rows, elements=told),
        threshold=floats(draw, rows, elements=told),
        resolution_cells=floats(draw, rows, elements=told),
        gate_volume=floats(draw, rows, elements=told),
        predicted_position=floats(draw, rows, 2),
        gate_covariance=floats(draw, rows, 2, 2),
        search_false_alarm_probability=draw(told),
        search_threshold=draw(told),
        signal_to_noise_ratio_linear=floats(draw, rows, elements=told),
        method="closed_form",
        next_stamp=draw(stamps),
    )


def through_the_wire(message: Any) -> Any:
    return deserialize_message(serialize_message(message), type(message))


def assert_same(found: Any, record: Any) -> None:
    for field in dataclasses.fields(record):
        one, other = getattr(found, field.name), getattr(record, field.name)
        np.testing.assert_array_equal(one, other, err_msg=field.name)


@pytest.mark.slow
@given(contacts())
def test_contacts_come_back(record: Contacts) -> None:
    found = contacts_from_message(through_the_wire(contacts_to_message(record)))
    if not len(record.range):
        # Without contacts an unknown deviation cannot be told from none.
        empty: dict[str, Any] = {
            name: getattr(record, name)
            for name in ("range_standard_deviation", "azimuth_standard_deviation")
            if np.any(np.isnan(getattr(record, name)))
        }
        found = dataclasses.replace(found, **empty)
    assert_same(found, record)


@pytest.mark.slow
@given(thresholds())
def test_thresholds_come_back(record: GateThresholds) -> None:
    assert_same(thresholds_from_message(through_the_wire(thresholds_to_message(record))), record)


@pytest.mark.parametrize("yaw", [0.0, 1.0, -2.5, 3.1, np.nan])
def test_the_yaw_of_the_sensor_comes_back(yaw: float) -> None:
    record = dataclasses.replace(some_contacts(), sensor_yaw=yaw)
    found = contacts_from_message(through_the_wire(contacts_to_message(record)))
    assert found.sensor_yaw == pytest.approx(yaw, nan_ok=True)


def some_contacts() -> Contacts:
    return Contacts(
        stamp=10**9,
        range=np.array([1000.0, 2000.0]),
        azimuth=np.array([0.1, 0.2]),
        amplitude=np.array([3.0, 4.0]),
        range_standard_deviation=10.0,
        azimuth_standard_deviation=0.01,
    )


@pytest.mark.parametrize(
    ("name", "length"),
    [
        ("azimuth", 1),
        ("azimuth", 0),
        ("amplitude", 3),
        ("range_standard_deviation", 3),
        ("azimuth_standard_deviation", 4),
    ],
)
def test_columns_of_unequal_length_are_named(name: str, length: int) -> None:
    message = contacts_to_message(some_contacts())
    setattr(message, name, array.array("d", [1.0] * length))
    with pytest.raises(InputError, match=rf"Contacts\.{name} has {length} values.*range has 2"):
        contacts_from_message(message)
    change: dict[str, Any] = {name: np.ones(length)}
    malformed = dataclasses.replace(some_contacts(), **change)
    if length > 1:
        with pytest.raises(InputError, match=name):
            contacts_to_message(malformed)


def test_what_is_not_told_is_unknown() -> None:
    """Deviations, pose and numbers of a message that only has ranges and azimuths."""
    message = contacts_to_message(
        Contacts(
            stamp=10**9,
            range=np.array([1000.0, 2000.0]),
            azimuth=np.array([0.1, 0.2]),
            amplitude=np.empty(0),
            range_standard_deviation=np.nan,
            azimuth_standard_deviation=np.nan,
            sensor_position=(np.nan, np.nan),
        )
    )
    assert len(message.range_standard_deviation) == len(message.amplitude) == 0
    found = contacts_from_message(message)
    assert np.isnan(found.range_standard_deviation) and np.isnan(found.azimuth_standard_deviation)
    assert np.all(np.isnan(found.sensor_position)) and np.isnan(found.sensor_yaw)
    assert all(np.isnan(getattr(found, name)) for name in CONTACT_REALS)
