"""Position tracks to messages.

The other way is :mod:`sonar_tracking.message_reading.position_reading`.

Every message is checked before it is published: columns of unequal length raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths.
"""

from __future__ import annotations

import numpy as np
from sonar_tracking_msgs.msg import Tracks

from sonar_tracking.graph.message_writing.field_writing import packed, set_stamps
from sonar_tracking.message_reading.position_reading import STATE_NAMES, check_position_columns
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import COLUMNS, MAP_FRAME, PositionTracks, TruthTracks


def position_tracks_to_message(record: PositionTracks) -> Tracks:
    """Return position tracks as a message.

    Parameters
    ----------
    record : PositionTracks
        The complete picture at its stamp.

    Returns
    -------
    Tracks
        With every column of the record.
    """
    message = Tracks()
    set_stamps(message, record.stamp, record.next_stamp)
    message.header.frame_id = record.frame_id
    for name, described in COLUMNS.items():
        if name != "state":
            setattr(message, name, packed(getattr(record, name), described.dtype))
    for index, name in enumerate(STATE_NAMES):
        setattr(message, name, packed(record.state[:, index]))
    message.contributor_sensor = list(record.contributor_sensor)
    check_position_columns(message)
    return message


def truth_tracks_to_message(record: TruthTracks) -> Tracks:
    """Return true positions as a track list of source TRUTH."""
    rows = len(record.id)
    message = Tracks()
    set_stamps(message, record.stamp, record.next_stamp)
    message.header.frame_id = MAP_FRAME
    message.id = packed(record.id, "uint64")
    message.status = packed(np.full(rows, TrackStatus.CONFIRMED), "uint8")
    message.source = packed(np.full(rows, Tracks.TRUTH), "uint8")
    message.existence_probability = packed(np.ones(rows))
    message.x, message.y = packed(record.position[:, 0]), packed(record.position[:, 1])
    message.vx, message.vy = packed(record.velocity[:, 0]), packed(record.velocity[:, 1])
    return message
