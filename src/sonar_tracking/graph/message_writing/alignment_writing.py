"""Alignments of arrays to messages.

The other way is :mod:`sonar_tracking.message_reading.alignment_reading`.
"""

from __future__ import annotations

from sonar_tracking_msgs.msg import ArrayAlignments as ArrayAlignmentsMessage

from sonar_tracking.graph.message_writing.field_writing import packed, set_stamps
from sonar_tracking.message_reading.alignment_reading import ALIGNMENT_WIDTHS
from sonar_tracking.message_reading.field_reading import check_columns
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.positions import MAP_FRAME


def alignments_to_message(record: ArrayAlignments) -> ArrayAlignmentsMessage:
    """Return how arrays are turned from what their data tell, as a message."""
    message = ArrayAlignmentsMessage()
    set_stamps(message, record.stamp, record.next_stamp)
    message.header.frame_id = MAP_FRAME
    message.sensor_id = list(record.sensor_id)
    for name in ALIGNMENT_WIDTHS:
        setattr(message, name, packed(getattr(record, name)))
    check_columns(message, "sensor_id", ALIGNMENT_WIDTHS)
    return message
