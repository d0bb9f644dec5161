"""Frequency lines from messages, wherever they come from.

Columns of unequal length raise :class:`sonar_tracking.errors.InputError` naming message, field and
lengths. What the numbers mean is checked by the stages.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.message_reading.field_reading import (
    check_columns,
    column,
    rows_or_nan,
    sensor,
    stamp_from_time,
)
from sonar_tracking.records.lines import NOT_ATTRIBUTED, FrequencyLines

LINE_REALS = (
    "arrival_angle",
    "arrival_angle_variance",
    "frequency",
    "standard_deviation",
    "signal_to_noise_ratio",
    "integration_time",
)
LINE_WIDTHS = dict.fromkeys(LINE_REALS, 1) | {"track_id": 1}
"""Values per line of every column of FrequencyLines."""


def frequency_lines_from_message(message: Any) -> FrequencyLines:
    """Return the lines a message carries.

    Parameters
    ----------
    message : FrequencyLines
        Received, or decoded from a bag.

    Returns
    -------
    FrequencyLines
        A column that is not reported is NaN; lines without tracks are not attributed.

    Raises
    ------
    InputError
        When columns have unequal lengths.
    """
    rows = check_columns(message, "line_id", LINE_WIDTHS)
    reals = {name: rows_or_nan(message, name, (rows,)) for name in LINE_REALS}
    tracks = column(message, "track_id", "uint64")
    return FrequencyLines(
        stamp=stamp_from_time(message.header.stamp),
        track_id=tracks if tracks.size else np.full(rows, NOT_ATTRIBUTED, np.uint64),
        line_id=column(message, "line_id", "uint64"),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor=sensor(message),
        **reals,
    )
