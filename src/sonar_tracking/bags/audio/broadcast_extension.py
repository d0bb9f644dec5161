"""The time in the ``bext`` chunk of a Broadcast Wave file (EBU Tech 3285).

Recorders write when a file was begun as date and time of day, and as samples since midnight.
"""

from __future__ import annotations

import re
import struct
from datetime import datetime, timezone
from pathlib import Path

from sonar_tracking.bags.audio.audio_file import BroadcastOrigin
from sonar_tracking.records.time import NANOSECONDS

_DATE, _TIME, _REFERENCE, _SHORTEST = 320, 330, 338, 346
_DAY = 86400
_AGREEING = 2.0
"""Difference of the two statements below which the finer one is taken, s."""


def broadcast_origin(path: Path, body: bytes, sample_rate: int) -> BroadcastOrigin | None:
    """Return what a ``bext`` chunk says of the begin of the file, or None if it does not.

    Parameters
    ----------
    path : Path
        The file, named in the doubt.
    body : bytes
        The chunk.
    sample_rate : int
        Hz.
    """
    if len(body) < _SHORTEST:
        return None
    date = re.findall(r"\d+", body[_DATE : _DATE + 10].decode("latin-1"))
    clock = re.findall(r"\d+", body[_TIME : _TIME + 8].decode("latin-1"))
    (reference,) = struct.unpack_from("<Q", body, _REFERENCE)
    try:
        year, month, day, hour, minute, second = (int(part) for part in (*date, *clock))
        begin = datetime(year, month, day, hour, minute, second, tzinfo=timezone.utc)
    except ValueError:
        return None
    seconds = int(begin.timestamp())
    if seconds <= 0:
        return None
    if not reference:
        return BroadcastOrigin(seconds * NANOSECONDS)
    since_midnight = reference / sample_rate
    off = (since_midnight - seconds % _DAY + _DAY / 2) % _DAY - _DAY / 2
    if abs(off) <= _AGREEING:
        return BroadcastOrigin(seconds * NANOSECONDS + round(off * NANOSECONDS))
    return BroadcastOrigin(
        seconds * NANOSECONDS,
        f"{path}: its bext chunk says {begin:%H:%M:%S} as time of day, and {since_midnight:.0f} s "
        "as time since midnight; the time of day is taken, --epoch gives another.",
    )
