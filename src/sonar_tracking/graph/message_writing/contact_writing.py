"""Contacts and thresholds to messages; the other way is :mod:`sonar_tracking.messages`.

Every message is checked before it is published: columns of unequal length raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths.
"""

from __future__ import annotations

import math

import numpy as np
from sonar_tracking_msgs.msg import Contacts as ContactsMessage
from sonar_tracking_msgs.msg import DetectionThreshold

from sonar_tracking.graph.message_writing.field_writing import (
    packed,
    set_quaternion,
    set_stamps,
    set_vector,
)
from sonar_tracking.message_reading.contact_reading import (
    CONTACT_REALS,
    DEVIATIONS,
    GATE_REALS,
    GATE_WIDTHS,
    check_contact_columns,
)
from sonar_tracking.message_reading.field_reading import check_columns
from sonar_tracking.records.contacts import Contacts, GateThresholds
from sonar_tracking.records.positions import MAP_FRAME


def contacts_to_message(record: Contacts) -> ContactsMessage:
    """Return the contacts of a ping as a message.

    Parameters
    ----------
    record : Contacts
        What is NaN is left to the receiver.
    """
    message = ContactsMessage()
    set_stamps(message, record.stamp, record.next_stamp)
    message.header.frame_id = record.frame_id
    message.sensor_id = record.sensor_id
    set_vector(message.sensor_pose.position, (*record.sensor_position, 0.0))
    half = 0.5 * record.sensor_yaw
    turn = (0.0, 0.0, math.sin(half), math.cos(half)) if math.isfinite(half) else (math.nan,) * 4
    set_quaternion(message.sensor_pose.orientation, turn)
    set_vector(message.sensor_velocity, (*record.sensor_velocity, 0.0))
    for name in ("range", "azimuth", "amplitude"):
        setattr(message, name, packed(getattr(record, name)))
    for name in DEVIATIONS:
        values = np.atleast_1d(getattr(record, name))
        unknown = len(values) == 1 and np.isnan(values[0])
        setattr(message, name, packed(values[:0] if unknown else values))
    for name in CONTACT_REALS:
        setattr(message, name, float(getattr(record, name)))
    message.expected_signal_to_noise_ratio = float(record.signal_to_noise_ratio_linear)
    check_contact_columns(message)
    return message


def thresholds_to_message(record: GateThresholds) -> DetectionThreshold:
    """Return the detection thresholds of a ping as a message."""
    message = DetectionThreshold(method=record.method)
    set_stamps(message, record.stamp, record.next_stamp)
    message.header.frame_id = MAP_FRAME
    message.track_id = packed(record.track_id, "uint64")
    for name in GATE_REALS:
        setattr(message, name, packed(getattr(record, name)))
    message.predicted_x = packed(record.predicted_position[:, 0])
    message.predicted_y = packed(record.predicted_position[:, 1])
    message.gate_covariance = packed(record.gate_covariance)
    message.signal_to_noise_ratio = packed(record.signal_to_noise_ratio_linear)
    message.search_threshold = float(record.search_threshold)
    message.search_false_alarm_probability = float(record.search_false_alarm_probability)
    check_columns(message, "track_id", GATE_WIDTHS)
    return message
