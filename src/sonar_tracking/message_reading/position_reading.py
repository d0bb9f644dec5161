"""Position tracks from messages, wherever they come from.

The columns of every message are checked here: unequal lengths raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.message_reading.field_reading import check_columns, column, stamp_from_time
from sonar_tracking.records.positions import COLUMNS, PositionTracks

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
        A column that is not reported is NaN, zero (``status``, ``source``, ``hypothesis``,
        identifiers) or the empty name.

    Raises
    ------
    InputError
        When columns have unequal lengths, or a line or contributor belongs to no row.
    """
    rows = check_position_columns(message)
    columns = {
        name: column(message, name, described.dtype).reshape(-1, *described.width)
        for name, described in COLUMNS.items()
        if name != "state"
    }
    for name in ("status", "source"):
        if not columns[name].size:
            columns[name] = np.zeros(rows, np.uint8)
    return PositionTracks(
        stamp=stamp_from_time(message.header.stamp),
        state=np.stack([_reals(message, name, rows) for name in STATE_NAMES], axis=-1),
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


def _reals(message: Any, name: str, rows: int) -> Any:
    values = column(message, name)
    return values if values.size else np.full(rows, np.nan)
