"""Element time series and LOFAR rows to messages.

The other way, with the layout of the LOFAR image, is
:mod:`sonar_tracking.message_reading.sample_reading`.
"""

from __future__ import annotations

import numpy as np
from sensor_msgs.msg import Image
from sonar_tracking_msgs.msg import ArraySamples as ArraySamplesMessage

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.field_writing import (
    packed,
    set_element_positions,
    set_sensor,
    set_stamps,
    time_from_stamp,
)
from sonar_tracking.message_reading.sample_reading import LOFAR_AXIS, LOFAR_ENCODING
from sonar_tracking.records.lines import LofarRows
from sonar_tracking.records.samples import ArraySamples


def samples_to_message(record: ArraySamples) -> ArraySamplesMessage:
    """Return a block of samples as a message (data rounded to float32)."""
    if record.data.ndim != 2 or record.data.shape[1] != len(record.element_positions):
        raise InputError(
            f"ArraySamples.data has shape {record.data.shape}, but there are "
            f"{len(record.element_positions)} elements; give (n_samples, n_elements)."
        )
    message = ArraySamplesMessage()
    set_stamps(message, record.stamp, record.next_stamp)
    set_sensor(message, record.sensor)
    set_element_positions(message, record.element_positions)
    message.sample_rate = float(record.sample_rate)
    message.sound_speed = float(record.sound_speed)
    message.n_samples = len(record.data)
    message.data = packed(record.data, "float32")
    return message


def lofar_rows_to_message(record: LofarRows) -> Image:
    """Return rows of the LOFAR picture as an image."""
    height, width = record.level_db.shape
    axis = np.empty(height, LOFAR_AXIS)
    axis["track_id"] = record.track_id
    axis["first_frequency"] = record.first_frequency
    axis["bin_width"] = record.bin_width
    levels = np.ascontiguousarray(record.level_db, "<f4")
    rows = [
        levels.view(np.uint8).reshape(height, 4 * width),
        axis.view(np.uint8).reshape(height, LOFAR_AXIS.itemsize),
    ]
    message = Image(height=height, width=width, encoding=LOFAR_ENCODING, is_bigendian=0)
    message.header.stamp = time_from_stamp(record.stamp)
    message.header.frame_id = record.frame_id
    message.step = 4 * width + LOFAR_AXIS.itemsize
    message.data = packed(np.concatenate(rows, axis=1), "uint8")
    return message
