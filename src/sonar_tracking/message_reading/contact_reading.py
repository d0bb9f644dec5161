"""Contacts and detection thresholds from messages, wherever they come from.

The columns of every message are checked here: unequal lengths raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths. What the numbers mean
(NaN, negative amplitudes) is checked by the trackers.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.message_reading.field_reading import (
    check_columns,
    check_vector,
    column,
    known,
    real,
    rows_or_nan,
    sensor_orientation,
    stamp_from_time,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts, GateThresholds
from sonar_tracking.sensor_pose import is_unset, yaw_of

CONTACT_WIDTHS = {"azimuth": 1, "amplitude": 1}
"""Values per contact of the columns of Contacts beside range."""

DEVIATIONS = ("range_standard_deviation", "azimuth_standard_deviation")

CONTACT_REALS = (
    "ping_interval",
    "detection_threshold",
    "detection_probability",
    "false_alarm_probability",
    "clutter_density",
    "range_resolution",
    "azimuth_resolution",
    "minimum_range",
    "maximum_range",
    "minimum_azimuth",
    "azimuth_width",
)
"""Fields of Contacts that are called the same in the record; NaN = unknown."""

GATE_REALS = ("false_alarm_probability", "threshold", "resolution_cells", "gate_volume")
GATE_WIDTHS = dict.fromkeys(
    (*GATE_REALS, "predicted_x", "predicted_y", "signal_to_noise_ratio"), 1
) | {"gate_covariance": 4}
"""Values per gate of every column of DetectionThreshold beside track_id."""


def contacts_from_message(message: Any) -> Contacts:
    """Return the contacts a message carries.

    Parameters
    ----------
    message : Contacts
        Received, or decoded from a bag.

    Returns
    -------
    Contacts
        What the message does not tell is NaN: position, velocity and yaw of the sensor, too.

    Raises
    ------
    InputError
        When columns have unequal lengths.
    """
    check_contact_columns(message)
    position, velocity = message.sensor_pose.position, message.sensor_velocity
    check_vector(message, "sensor_pose.position", position)
    check_vector(message, "sensor_velocity", velocity)
    orientation = sensor_orientation(message)
    return Contacts(
        stamp=stamp_from_time(message.header.stamp),
        range=column(message, "range"),
        azimuth=column(message, "azimuth"),
        amplitude=column(message, "amplitude"),
        range_standard_deviation=_deviation(message, "range_standard_deviation"),
        azimuth_standard_deviation=_deviation(message, "azimuth_standard_deviation"),
        sensor_position=(position.x, position.y),
        sensor_velocity=(velocity.x, velocity.y),
        signal_to_noise_ratio_linear=real(message, "expected_signal_to_noise_ratio"),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor_id=message.sensor_id,
        frame_id=message.header.frame_id,
        sensor_yaw=yaw_of(orientation),
        unset_pose=is_unset(
            (position.x, position.y, position.z),
            orientation,
            (velocity.x, velocity.y, velocity.z),
        ),
        **{name: real(message, name) for name in CONTACT_REALS},
    )


def thresholds_from_message(message: Any) -> GateThresholds:
    """Return the detection thresholds a message carries; a column not reported is NaN.

    Raises
    ------
    InputError
        When columns have unequal lengths.
    """
    rows = check_columns(message, "track_id", GATE_WIDTHS)
    x, y = (rows_or_nan(message, f"predicted_{axis}", (rows,)) for axis in "xy")
    return GateThresholds(
        stamp=stamp_from_time(message.header.stamp),
        track_id=column(message, "track_id", "uint64").astype(np.int64),
        predicted_position=np.stack([x, y], axis=-1),
        gate_covariance=rows_or_nan(message, "gate_covariance", (rows, 2, 2)),
        search_false_alarm_probability=real(message, "search_false_alarm_probability"),
        search_threshold=real(message, "search_threshold"),
        signal_to_noise_ratio_linear=rows_or_nan(message, "signal_to_noise_ratio", (rows,)),
        method=message.method,
        next_stamp=stamp_from_time(message.next_stamp),
        **{name: rows_or_nan(message, name, (rows,)) for name in GATE_REALS},
    )


def check_contact_columns(message: Any) -> int:
    """Check the columns of a Contacts message and return its number of contacts.

    Raises
    ------
    InputError
        Naming message, field and both lengths.
    """
    rows = check_columns(message, "range", CONTACT_WIDTHS)
    if len(message.azimuth) != rows:
        raise InputError(
            f"Contacts.azimuth has {len(message.azimuth)} values, but range has {rows}; the "
            "sender must give a direction for each contact."
        )
    for name in DEVIATIONS:
        length = len(getattr(message, name))
        if length not in (0, 1, rows):
            raise InputError(
                f"Contacts.{name} has {length} values, but range has {rows}; the sender must give "
                "one for all contacts, one for each, or none."
            )
    return rows


def _deviation(message: Any, name: str) -> float | FloatArray:
    values = known(message, name)
    if len(values) == 1:
        return float(values[0])
    return values if values.size or not len(message.range) else np.nan
