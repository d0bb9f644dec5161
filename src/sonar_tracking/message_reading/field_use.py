"""What a field says that the sender has not filled in: one table, for reading and reference.

A message that is made begins with zeros, empty columns and a sensor that rests at the origin of
``map``. Where zero makes no sense it is read as unknown, or the message is rejected with a sentence
that names the field. A zero with a meaning stays what it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import NamedTuple


class Unfilled(Enum):
    """What a field says that was left as it is in a new message."""

    REQUIRED = "required"
    """Nothing works without it: the message is rejected."""
    UNKNOWN = "unknown"
    """Zero makes no sense: it is unknown, as is an empty column; NaN in the record."""
    COLUMN = "column"
    """An empty column is unknown, NaN in the record; a zero in it is meant."""
    POSE = "pose"
    """See :mod:`sonar_tracking.sensor_pose`."""
    VALUE = "value"
    """Zero, or empty, is meant."""


class FieldUse(NamedTuple):
    """How a field is read.

    Attributes
    ----------
    unfilled : Unfilled
        What it says if it was left as it is in a new message.
    text : str
        What is required, what takes the place of what is unknown, or what zero means.
    condition : str
        When it is required; empty = always.
    """

    unfilled: Unfilled
    text: str = ""
    condition: str = ""


def required(text: str, condition: str = "") -> FieldUse:
    """Return the use of a field that must be filled in, what it is to hold, and when."""
    return FieldUse(Unfilled.REQUIRED, text, condition)


def unknown(text: str = "") -> FieldUse:
    """Return the use of a field whose zero is unknown, and what stands in for it."""
    return FieldUse(Unfilled.UNKNOWN, text)


def column(text: str = "") -> FieldUse:
    """Return the use of a column that is unknown where it is empty, and what stands in for it."""
    return FieldUse(Unfilled.COLUMN, text)


def value(text: str = "") -> FieldUse:
    """Return the use of a field whose zero is meant, and what it means."""
    return FieldUse(Unfilled.VALUE, text)


PARAMETER = "the parameter of the node is taken"

_HEAD = {
    "header": required("the stamp", "the stamp"),
    "next_stamp": unknown("who joins several topics waits for the next message"),
}
_SENSOR = _HEAD | {
    "sensor_id": value("a sensor without a name"),
    "sensor_pose": FieldUse(Unfilled.POSE),
    "sensor_velocity": FieldUse(Unfilled.POSE, "at rest beside a pose that was set"),
}
_ARRAY = {
    "sound_speed": required("the speed of sound in m/s"),
    "element_x": required("one position an element, not all at one place, in m"),
    "element_y": required("as many as element_x, in m"),
    "element_z": required("as many as element_x, in m"),
}

FIELD_USES: Mapping[str, Mapping[str, FieldUse]] = {
    "ArraySnapshots": _SENSOR
    | _ARRAY
    | {
        "sample_period": required("the time between snapshots in s"),
        "center_frequency": required("the frequency in Hz"),
        "bandwidth": value("taken to be narrow enough for the array"),
        "n_snapshots": required("the number of snapshots"),
        "data": required("the snapshots"),
        "noise_covariance": value("white noise"),
    },
    "ArraySamples": _SENSOR
    | _ARRAY
    | {
        "sample_rate": required("the sample rate in Hz"),
        "n_samples": required("the number of samples"),
        "data": required("the samples"),
    },
    "SubspaceEstimates": _SENSOR
    | _ARRAY
    | {
        "method": value("not named; some methods of the tracker need to know"),
        "sample_period": required("the time between snapshots in s"),
        "center_frequency": required("the frequency in Hz"),
        "bandwidth": value("not used"),
        "effective_snapshots": required("the independent snapshots a subspace stands for"),
        "rank": unknown("unless there are eigenvalues"),
        "source_count": unknown("unless there are eigenvalues"),
        "n_subspaces": value("none at this sample time"),
        "n_columns": value("none at this sample time"),
        "time_offsets": value("none at this sample time"),
        "basis": value("none at this sample time"),
        "eigenvalues": column(),
        "noise_power": unknown(),
        "covariance": column(),
        "covariance_snapshots": required("the number of snapshots in it", "beside a covariance"),
        "covariance_time_offset": value("at the stamp"),
        "noise_covariance": value("white noise"),
    },
    "BearingTracks": _SENSOR
    | {
        "angle_kind": value("CONE"),
        "id": value("no tracks; number them from 1"),
        "status": column("CONFIRMED is taken"),
        "arrival_angle": column(),
        "arrival_angle_rate": column(),
        "covariance": column(),
        "measurement": required("the angles measured, rad", "for target motion analysis"),
        "measurement_variance": unknown("azimuth_deviation_deg of the node is taken"),
        "innovation": column(),
        "signal_to_noise_ratio": unknown(),
        "existence_probability": column(),
        "ambiguous": column("a cone has two sides"),
        "elevation": column(),
        "elevation_variance": unknown(),
    },
    "FrequencyLines": _SENSOR
    | {
        "track_id": value("not attributed"),
        "arrival_angle": column(),
        "arrival_angle_variance": unknown(),
        "line_id": value("no lines"),
        "frequency": unknown("the line is left out"),
        "standard_deviation": unknown("the line is left out"),
        "signal_to_noise_ratio": unknown(),
        "integration_time": unknown(),
    },
    "Contacts": _SENSOR
    | {
        "ping_interval": unknown(),
        "range": value("no contacts"),
        "azimuth": required("as many as range, in rad", "beside ranges"),
        "amplitude": column("association by distance alone"),
        "range_standard_deviation": unknown(PARAMETER + "; without either the ping is rejected"),
        "azimuth_standard_deviation": unknown(PARAMETER + "; without either the ping is rejected"),
        "detection_threshold": unknown(PARAMETER),
        "detection_probability": unknown(PARAMETER),
        "false_alarm_probability": unknown(PARAMETER),
        "expected_signal_to_noise_ratio": unknown(PARAMETER),
        "clutter_density": unknown(PARAMETER),
        "range_resolution": unknown(PARAMETER),
        "azimuth_resolution": unknown(PARAMETER),
        "minimum_range": value("from the sensor on"),
        "maximum_range": unknown(PARAMETER),
        "minimum_azimuth": value("the sector begins at +x"),
        "azimuth_width": unknown(PARAMETER),
    },
    "DetectionThreshold": _HEAD
    | {
        "track_id": value("no gates"),
        "false_alarm_probability": unknown(),
        "threshold": unknown(),
        "resolution_cells": unknown(),
        "gate_volume": unknown(),
        "predicted_x": column(),
        "predicted_y": column(),
        "gate_covariance": column(),
        "search_threshold": unknown(),
        "search_false_alarm_probability": unknown(),
        "signal_to_noise_ratio": unknown(),
        "method": value("not named"),
    },
    "ArrayAlignments": _HEAD
    | {
        "sensor_id": value("no arrays"),
        "misalignment": column(),
        "misalignment_standard_deviation": column(),
    },
    "Tracks": _HEAD
    | {
        "id": value("no tracks; number them from 1"),
        "status": column("CONFIRMED is taken"),
        "source": value("ACTIVE"),
        "existence_probability": column(),
        "x": column(),
        "y": column(),
        "vx": column(),
        "vy": column(),
        "covariance": column(),
        "z": column(),
        "z_standard_deviation": column(),
        "initiated": unknown(),
        "updated": unknown(),
        "observability": column(),
        "hypothesis": value("SINGLE"),
        "hypothesis_probability": column(),
        "bearing_track_id": value("none"),
        "measurement": column(),
        "measurement_covariance": column(),
        "line_track": value("no lines"),
        "line_id": value("none"),
        "line_frequency": unknown(),
        "line_frequency_standard_deviation": unknown(),
        "contributor_track": value("no contributors"),
        "contributor_source": value("ACTIVE"),
        "contributor_sensor": value("not named"),
        "contributor_id": value("none"),
    },
    "OperatorCommand": {
        "header": value("it takes effect before the next datum"),
        "command": required("what is to be done"),
        "topic": required("the track list that is meant"),
        "id": required("the track that is meant", "for all but START_TRACK and lines"),
        "other_id": value("none"),
        "arrival_angle": value("broadside"),
        "x": value("at the origin"),
        "y": value("at the origin"),
        "side": required("the side of the line array", "for CHOOSE_SIDE"),
        "frequency": value("none"),
        "bandwidth": value("1 Hz"),
        "sensor_id": value("all sensors"),
        "name": value("none"),
    },
    "Odometry": {
        "header": required("the stamp", "the stamp"),
        "child_frame_id": value("not read"),
        "pose": required(
            "own ship in map", "the position; without an orientation the course is taken"
        ),
        "twist": unknown("where the positions move: their rate is taken"),
    },
}
"""Message, field, use. The messages are those of ``sonar_tracking_msgs``, and Odometry."""
