"""Serialised bearing tracks and frequency lines made without ROS."""

from __future__ import annotations

import numpy as np

from sonar_tracking.bags.importers.recorded_messages import message_head, serialised
from sonar_tracking.bags.storage.bag_records import BEARING_TRACKS_TYPE, FREQUENCY_LINES_TYPE
from sonar_tracking.message_reading.line_reading import LINE_REALS
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import FrequencyLines

_BEARING_COLUMNS = (
    "id",
    "status",
    "arrival_angle",
    "arrival_angle_rate",
    "covariance",
    "measurement",
    "measurement_variance",
    "innovation",
    "signal_to_noise_ratio",
    "existence_probability",
    "ambiguous",
    "elevation",
    "elevation_variance",
)


def bearing_tracks_cdr(tracks: BearingTracks) -> bytes:
    """Return a serialised BearingTracks message."""
    values = message_head(tracks.sensor, tracks.stamp, tracks.next_stamp, BEARING_TRACKS_TYPE)
    values["angle_kind"] = int(tracks.angle_kind)
    for name in _BEARING_COLUMNS:
        values[name] = np.ascontiguousarray(np.ravel(getattr(tracks, name)))
    return serialised(BEARING_TRACKS_TYPE, values)


def frequency_lines_cdr(lines: FrequencyLines) -> bytes:
    """Return a serialised FrequencyLines message."""
    values = message_head(lines.sensor, lines.stamp, lines.next_stamp, FREQUENCY_LINES_TYPE)
    for name in ("track_id", "line_id", *LINE_REALS):
        values[name] = np.ascontiguousarray(getattr(lines, name))
    return serialised(FREQUENCY_LINES_TYPE, values)
