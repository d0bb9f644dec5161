"""What the sender has not filled in is unknown, or an error, never a number it did not mean.

Every field of every message, one at a time, in messages as a ROS node makes them.
"""

from __future__ import annotations

import array
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from sonar_tracking_msgs import msg

from sonar_tracking.errors import InputError
from sonar_tracking.graph.node_base.stamp_check import Verdict
from sonar_tracking.graph.node_base.stamp_guard import StampGuard
from sonar_tracking.message_reading.alignment_reading import alignments_from_message
from sonar_tracking.message_reading.array_reading import (
    directions_from_message,
    measured_directions_from_message,
    own_ship_from_message,
    snapshots_from_message,
    subspaces_from_message,
)
from sonar_tracking.message_reading.command_reading import command_from_message
from sonar_tracking.message_reading.contact_reading import (
    contacts_from_message,
    thresholds_from_message,
)
from sonar_tracking.message_reading.field_use import FIELD_USES, Unfilled
from sonar_tracking.message_reading.line_reading import frequency_lines_from_message
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.message_reading.sample_reading import samples_from_message
from sonar_tracking.records.bearings import TrackStatus

CLASSES = {name: getattr(msg, name, Odometry) for name in FIELD_USES}
READ: dict[str, Callable[[Any], Any]] = {
    "ArraySnapshots": snapshots_from_message,
    "ArraySamples": samples_from_message,
    "SubspaceEstimates": subspaces_from_message,
    "BearingTracks": measured_directions_from_message,
    "FrequencyLines": frequency_lines_from_message,
    "Contacts": contacts_from_message,
    "DetectionThreshold": thresholds_from_message,
    "Tracks": position_tracks_from_message,
    "ArrayAlignments": alignments_from_message,
    "OperatorCommand": command_from_message,
    "Odometry": own_ship_from_message,
}
ROWS = {"BearingTracks": "id", "FrequencyLines": "line_id", "Contacts": "range", "Tracks": "id"}
ROWS |= {"DetectionThreshold": "track_id", "ArrayAlignments": "sensor_id"}
WIDE = {"covariance": {"Tracks": 16, "BearingTracks": 4}, "gate_covariance": {"": 4}}
WIDE |= {"measurement": {"Tracks": 2}, "measurement_covariance": {"Tracks": 4}}
LISTS_OF_THEIR_OWN = ("line_", "contributor_")
FIELDS = [(name, field) for name, uses in FIELD_USES.items() for field in uses]


def columns_of(name: str) -> list[str]:
    """Return the columns of a list that are numbers, but for those of its own rows."""
    types = CLASSES[name].get_fields_and_field_types()
    return [
        field
        for field, kind in types.items()
        if kind.startswith("sequence")
        and not (name == "Tracks" and field.startswith(LISTS_OF_THEIR_OWN))
    ]


def filled(name: str) -> Any:
    """Return a message of two elements, or two rows, with everything filled in."""
    message = CLASSES[name]()
    if name == "Odometry":
        message.header.stamp.sec = 5
        message.twist.twist.linear.x = 3.0
        return message
    message.header.stamp.sec, message.header.frame_id = 5, "own_ship/array"
    if name == "OperatorCommand":
        message.command, message.topic = message.CHOOSE_SIDE, "passive/tracks"
        message.id, message.side = 7, message.LEFT
        return message
    message.next_stamp.sec = 6
    types = message.get_fields_and_field_types()
    for field, kind in types.items():
        if kind in ("double", "uint32", "int32", "uint8"):
            setattr(message, field, 2 if "int" in kind else 2.0)
    if "sensor_pose" in types:
        message.sensor_id = "sonar"
        message.sensor_pose.position.x = message.sensor_velocity.x = 3.0
    if name in ROWS:
        for field in columns_of(name):
            width = 2 * WIDE.get(field, {}).get(name, 4 if field == "gate_covariance" else 1)
            values = {"ambiguous": [True] * 2, "sensor_id": ["array", "buoy"]}.get(field)
            setattr(message, field, values or [1] * width)
        if name == "BearingTracks":
            message.angle_kind = 1
        return message
    for axis in "xyz":
        setattr(message, f"element_{axis}", array.array("d", [0.0, 1.0]))
    identity = array.array("d", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    if name != "ArraySamples":
        message.noise_covariance = identity
    if name == "SubspaceEstimates":
        message.n_subspaces = message.n_columns = 1
        message.time_offsets = array.array("d", [0.1])
        message.basis = array.array("d", [1.0] * 4)
        message.covariance, message.eigenvalues = identity, array.array("d", [1.0, 1.0])
    else:
        n_values = 8 if name == "ArraySnapshots" else 4
        message.data = array.array("f", [1.0] * n_values)
    return message


def without(name: str, field: str) -> Any:
    """Return such a message with one field as it is in a new one."""
    message = filled(name)
    setattr(message, field, getattr(CLASSES[name](), field))
    return message


def recorded(record: Any, field: str) -> Any:
    """Return what a record says of a field; None where it has nothing of that name."""
    linear = f"{field.removeprefix('expected_')}_linear"
    return getattr(record, field, getattr(record, linear, None))


@pytest.mark.parametrize("name", FIELD_USES)
def test_the_table_holds_every_field_of_the_message(name: str) -> None:
    assert set(FIELD_USES[name]) == set(CLASSES[name].get_fields_and_field_types())


def test_the_table_holds_every_message_of_data() -> None:
    ours = {name for name in dir(msg) if name[0].isupper() and "_" not in name}
    assert set(FIELD_USES) == ours - {"Progress"} | {"Odometry"}


@pytest.mark.parametrize("name", FIELD_USES)
def test_a_message_with_everything_is_read(name: str) -> None:
    READ[name](filled(name))


@pytest.mark.parametrize(
    ("name", "field"),
    [(n, f) for n, f in FIELDS if FIELD_USES[n][f].unfilled is Unfilled.REQUIRED],
)
def test_what_is_required_is_asked_for_by_name(name: str, field: str) -> None:
    message = without(name, field)
    if field == "header":
        verdict = StampGuard("topic", 10**9).check(0, 0, "").verdict
        assert verdict is Verdict.REJECT
    elif (name, field) == ("Odometry", "pose"):
        READ[name](message)  # at the origin, towards the east: a place as good as any
    else:
        with pytest.raises(InputError, match=rf"{name}\..*{field}"):
            READ[name](message)


@pytest.mark.parametrize(
    ("name", "field"),
    [
        (n, f)
        for n, f in FIELDS
        if FIELD_USES[n][f].unfilled is Unfilled.UNKNOWN and f not in ("next_stamp", "twist")
    ],
)
def test_a_zero_without_sense_is_unknown(name: str, field: str) -> None:
    """In a single number, in a column of zeros, in an empty column."""
    messages = [without(name, field)]
    if not isinstance(getattr(messages[0], field), float | int):
        messages.append(filled(name))
        setattr(messages[1], field, [0.0, 0.0])
    if name == "Tracks" and field.startswith("line_"):
        for message in messages:
            message.line_track, message.line_id = [0, 1], [3, 4]
    if field in ("rank", "source_count"):
        messages[0].eigenvalues = []
    for message in messages:
        told = np.asarray(recorded(READ[name](message), field))
        if field == "elevation_variance" and not told.size:
            continue
        assert told.size and (np.isnan(told).all() or (told == -1).all())


@pytest.mark.parametrize(
    ("name", "field"), [(n, f) for n, f in FIELDS if FIELD_USES[n][f].unfilled is Unfilled.COLUMN]
)
def test_an_empty_column_is_unknown_and_its_zeros_are_meant(name: str, field: str) -> None:
    record = READ[name](without(name, field))
    zeros = filled(name)
    n_values = len(getattr(zeros, field))
    setattr(zeros, field, [False] * n_values if field == "ambiguous" else [0] * n_values)
    meant = READ[name](zeros)
    if field in ("x", "y", "vx", "vy"):
        column = ("x", "y", "vx", "vy").index(field)
        empty, zero = record.state[:, column], meant.state[:, column]
    elif field.startswith("predicted_"):
        empty, zero = (r.predicted_position[:, "xy".index(field[-1])] for r in (record, meant))
    else:
        empty, zero = (getattr(each, field) for each in (record, meant))
    assert zero is None or not np.any(zero)
    if field == "status":
        assert empty.tolist() == [TrackStatus.CONFIRMED] * 2
    else:
        assert empty is None or not np.size(empty) or np.all(np.isnan(empty)) or not empty.any()


def test_a_cone_whose_sides_nobody_tells_has_two() -> None:
    message = without("BearingTracks", "ambiguous")
    message.angle_kind = 0
    assert directions_from_message(message).ambiguous.all()
    message.angle_kind = 1
    assert not directions_from_message(message).ambiguous.any()


@pytest.mark.parametrize(
    ("name", "field"), [(n, f) for n, f in FIELDS if FIELD_USES[n][f].unfilled is Unfilled.VALUE]
)
def test_a_zero_that_is_meant_stays(name: str, field: str) -> None:
    message = without(name, field)
    if field == ROWS.get(name):
        message = CLASSES[name]()
    if field in ("n_subspaces", "n_columns", "time_offsets", "basis"):
        message.n_subspaces, message.time_offsets, message.basis = 0, [], []
    record = READ[name](message)
    told = recorded(record, field)
    assert told is None or not np.any(told) or field == "contributor_sensor"


def test_a_pose_that_nobody_has_set_is_passed_on_as_it_is() -> None:
    """Only who knows own ship's motion can tell; a place that is unknown has no turn either."""
    sensor = snapshots_from_message(without("ArraySnapshots", "sensor_pose")).sensor
    assert sensor.position == (0.0, 0.0, 0.0) and sensor.orientation == (0.0, 0.0, 0.0, 1.0)
    contacts = without("Contacts", "sensor_pose")
    assert not contacts_from_message(contacts).unset_pose  # a sensor that moves was set
    contacts.sensor_velocity.x = 0.0
    assert contacts_from_message(contacts).unset_pose
    message = without("ArraySnapshots", "sensor_pose")
    message.sensor_pose.position.x = np.nan
    assert np.isnan(snapshots_from_message(message).sensor.orientation).all()


def test_elements_at_one_place_are_refused() -> None:
    message = filled("ArraySamples")
    for axis in "xyz":
        setattr(message, f"element_{axis}", array.array("d", [0.0, 0.0]))
    with pytest.raises(InputError, match="element_x and element_y and element_z are 0"):
        samples_from_message(message)


@pytest.mark.parametrize("name", FIELD_USES)
def test_a_new_message_is_refused_by_name_or_holds_nothing(name: str) -> None:
    message = CLASSES[name]()
    try:
        record = READ[name](message)
    except InputError as error:
        assert f"{name}." in str(error) and "was not filled in" in str(error)
    else:
        rows = ROWS.get(name, "position")
        assert not np.any(getattr(record, rows))
