"""Element time series and rows of the LOFAR picture from messages, wherever they come from.

Rows of the LOFAR picture travel as a ``sensor_msgs/Image`` of encoding 32FC1 that any viewer can
show: one row a beam, one column a frequency, the power over the background in decibel. Behind the
columns, in the padding that ``step`` allows, each row ends with what the columns mean: bearing
track (uint64), frequency of the first column and distance of the columns (both float64, Hz).

Malformed messages raise :class:`sonar_tracking.errors.InputError`; what the numbers mean is checked
by the stages.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.errors import InputError, shown
from sonar_tracking.message_reading.field_limits import check_duration
from sonar_tracking.message_reading.field_reading import (
    check_largest,
    column,
    count,
    element_positions,
    real,
    sensor,
    stamp_from_time,
)
from sonar_tracking.records.lines import LofarRows
from sonar_tracking.records.samples import ArraySamples

LOFAR_ENCODING = "32FC1"

LOFAR_AXIS = np.dtype([("track_id", "<u8"), ("first_frequency", "<f8"), ("bin_width", "<f8")])
"""What each row ends with."""


def samples_from_message(message: Any) -> ArraySamples:
    """Return the block of samples a message carries.

    Raises
    ------
    InputError
        When a field that is required was not filled in, or the number of values is not samples x
        elements.
    """
    positions = element_positions(message)
    values = column(message, "data", "float32")
    n_samples = count(message, "n_samples")
    rate = real(message, "sample_rate")
    check_duration("ArraySamples", n_samples / rate)
    check_largest(message, "data", values)
    if values.size != n_samples * len(positions):
        raise InputError(
            f"ArraySamples.data has {values.size} values, but n_samples x elements = {n_samples} x "
            f"{len(positions)} need {n_samples * len(positions)}; the sender must make them agree."
        )
    return ArraySamples(
        stamp=stamp_from_time(message.header.stamp),
        data=values.reshape(n_samples, len(positions)).astype(np.float64),
        element_positions=positions,
        sample_rate=rate,
        sound_speed=real(message, "sound_speed"),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor=sensor(message),
    )


def lofar_rows_from_message(message: Any) -> LofarRows:
    """Return the rows of the LOFAR picture an image carries.

    Raises
    ------
    InputError
        When the image is of another kind.
    """
    height, width, step = int(message.height), int(message.width), int(message.step)
    size = LOFAR_AXIS.itemsize
    expected = 4 * width + size
    if message.encoding != LOFAR_ENCODING or message.is_bigendian or (height and step != expected):
        raise InputError(
            f"The image has encoding {shown(message.encoding)} and {step} bytes a row of "
            f"{width} columns; LOFAR rows are {LOFAR_ENCODING}, little endian, {expected} bytes "
            "a row."
        )
    data = column(message, "data", "uint8")
    if data.size != height * step:
        raise InputError(
            f"The image has {data.size} bytes, but height x step = {height} x {step} need "
            f"{height * step}; the sender must make them agree."
        )
    rows = data.reshape(height, expected if height == 0 else step)
    axis = np.frombuffer(rows[:, 4 * width :].tobytes(), LOFAR_AXIS)
    return LofarRows(
        stamp=stamp_from_time(message.header.stamp),
        track_id=axis["track_id"].astype(np.uint64),
        first_frequency=float(axis["first_frequency"][0]) if height else np.nan,
        bin_width=float(axis["bin_width"][0]) if height else np.nan,
        level_db=np.frombuffer(rows[:, : 4 * width].tobytes(), "<f4").reshape(height, width),
        frame_id=message.header.frame_id,
    )
