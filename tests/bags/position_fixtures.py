"""Position tracks as serialised messages, made without ROS."""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.bags.message_definitions import installed_typestore
from sonar_tracking.position_tracks import COLUMNS, PositionTracks
from tests.bags.bag_fixtures import SECOND, filled

POSITIONS = "sonar_tracking_msgs/msg/Tracks"


def position_tracks_cdr(tracks: PositionTracks) -> bytes:
    """Return a serialised list of position tracks."""
    columns: dict[str, Any] = {
        name: getattr(tracks, name).reshape(-1) for name in COLUMNS if name != "state"
    }
    for index, name in enumerate(("x", "y", "vx", "vy")):
        columns[name] = np.ascontiguousarray(tracks.state[:, index])
    message = filled(POSITIONS, contributor_sensor=list(tracks.contributor_sensor), **columns)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(tracks.stamp, SECOND)
    message.header.frame_id = tracks.frame_id
    return bytes(installed_typestore(POSITIONS).serialize_cdr(message, POSITIONS))
