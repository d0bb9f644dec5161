"""Alignments of arrays from messages, wherever they come from."""

from __future__ import annotations

from typing import Any

from sonar_tracking.message_reading.field_reading import (
    check_columns,
    rows_or_nan,
    stamp_from_time,
)
from sonar_tracking.records.alignments import ArrayAlignments

ALIGNMENT_WIDTHS = {"misalignment": 1, "misalignment_standard_deviation": 1}
"""Values per array of every column."""


def alignments_from_message(message: Any) -> ArrayAlignments:
    """Return the alignments a message carries.

    Parameters
    ----------
    message : ArrayAlignments
        Received, or decoded from a bag.

    Raises
    ------
    InputError
        When columns have unequal lengths.
    """
    rows = check_columns(message, "sensor_id", ALIGNMENT_WIDTHS)
    return ArrayAlignments(
        stamp=stamp_from_time(message.header.stamp),
        sensor_id=tuple(str(name) for name in message.sensor_id),
        next_stamp=stamp_from_time(message.next_stamp),
        **{name: rows_or_nan(message, name, (rows,)) for name in ALIGNMENT_WIDTHS},
    )
