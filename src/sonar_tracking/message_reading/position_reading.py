"""Position tracks from messages, wherever they come from.

The columns of every message are checked here: unequal lengths raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.message_reading.field_reading import (
    check_columns,
    column,
    known,
    rows_or_nan,
    stamp_from_time,
)
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import COLUMNS, PositionTracks, TrackSource

STATE_NAMES = ("x", "y", "vx", "vy")
"""Fields of the message that make up the state, in its order."""


def _widths(key: str) -> dict[str, int]:
    """Return the values per row of the columns that belong to a key column."""
    return {
        name: int(np.prod(described.width, dtype=int))
        for name, described in COLUMNS.items()
        if described.key == key and name not in (key, "state")
    }


TRACK_WIDTHS = _widths("id") | dict.fromkeys(STATE_NAMES, 1)
LINE_WIDTHS = _widths("line_track")
CONTRIBUTOR_WIDTHS = _widths("contributor_track") | {"contributor_sensor": 1}


def position_tracks_from_message(message: Any) -> PositionTracks:
    """Return the position tracks a message carries.

    Parameters
    ----------
    message : Tracks
        Received, or decoded from a bag.

    Returns
    -------
    PositionTracks
        A column that is not reported is NaN, confirmed (``status``), zero (``source``,
        ``hypothesis``, identifiers) or the empty name.

    Raises
    ------
    InputError
        When columns have unequal lengths, or a line or contributor belongs to no row.
    """
    rows = check_position_columns(message)
    columns = {
        name: _column(message, name, described.dtype).reshape(-1, *described.width)
        for name, described in COLUMNS.items()
        if name != "state"
    }
    if not columns["status"].size:
        columns["status"] = np.full(rows, TrackStatus.CONFIRMED, np.uint8)
    if not columns["source"].size:
        columns["source"] = np.full(rows, TrackSource.ACTIVE, np.uint8)
    return PositionTracks(
        stamp=stamp_from_time(message.header.stamp),
        state=np.stack([rows_or_nan(message, name, (rows,)) for name in STATE_NAMES], axis=-1),
        contributor_sensor=tuple(str(name) for name in message.contributor_sensor),
        next_stamp=stamp_from_time(message.next_stamp),
        frame_id=message.header.frame_id,
        **columns,
    )


def check_position_columns(message: Any) -> int:
    """Check the columns of a Tracks message and return its number of tracks.

    Raises
    ------
    InputError
        Naming message, field and both lengths.
    """
    check_columns(message, "line_track", LINE_WIDTHS)
    check_columns(message, "contributor_track", CONTRIBUTOR_WIDTHS)
    return check_columns(message, "id", TRACK_WIDTHS)


def _column(message: Any, name: str, dtype: str) -> NDArray[Any]:
    return known(message, name) if dtype == "float64" else column(message, name, dtype)
