"""Frequency lines to messages; the other way is :mod:`sonar_tracking.message_reading.line_reading`.

Every message is checked before it is published: columns of unequal length raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths.
"""

from __future__ import annotations

from sonar_tracking_msgs.msg import FrequencyLines as FrequencyLinesMessage

from sonar_tracking.graph.message_writing.field_writing import packed, set_sensor, set_stamps
from sonar_tracking.message_reading.field_reading import check_columns
from sonar_tracking.message_reading.line_reading import LINE_REALS, LINE_WIDTHS
from sonar_tracking.records.lines import FrequencyLines


def frequency_lines_to_message(record: FrequencyLines) -> FrequencyLinesMessage:
    """Return the lines heard at one instant as a message."""
    message = FrequencyLinesMessage()
    set_stamps(message, record.stamp, record.next_stamp)
    set_sensor(message, record.sensor)
    message.track_id = packed(record.track_id, "uint64")
    message.line_id = packed(record.line_id, "uint64")
    for name in LINE_REALS:
        setattr(message, name, packed(getattr(record, name)))
    check_columns(message, "line_id", LINE_WIDTHS)
    return message
