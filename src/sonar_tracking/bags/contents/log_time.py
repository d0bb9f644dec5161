"""Log times of recorded messages: the physical instant the message speaks of."""

from __future__ import annotations

import struct

from sonar_tracking.records.time import NANOSECONDS

CLOCK_TYPE = "rosgraph_msgs/msg/Clock"

_HEADED_SEQUENCE_TYPES = frozenset({"tf2_msgs/msg/TFMessage", "visualization_msgs/msg/MarkerArray"})
"""Types that are a sequence of what begins with a ``std_msgs/Header``."""

_ENCAPSULATION_BYTES = 4
_COUNT_BYTES = 4


class LogClock:
    """Gives each serialised message its log time.

    A message that begins with a header, or is a sequence of such, and ``/clock``, is logged at its
    own stamp; any other at the last clock seen, 0 = none yet. Log times never decrease within a
    topic, whatever the stamps do: players publish in log order, so a stamp that steps back keeps
    its place.

    Parameters
    ----------
    headed_types : frozenset of str
        Types that begin with a ``std_msgs/Header``.
    """

    def __init__(self, headed_types: frozenset[str]) -> None:
        self._stamped_types = headed_types | {CLOCK_TYPE}
        self._clock = 0
        self._last: dict[str, int] = {}

    def log_time(self, topic: str, type_name: str, data: bytes) -> int:
        """Return the log time of one message, ns.

        Parameters
        ----------
        topic, type_name : str
            Where it came from and what it is.
        data : bytes
            CDR with its encapsulation header.
        """
        stamp = head_stamp(data) if type_name in self._stamped_types else 0
        if type_name in _HEADED_SEQUENCE_TYPES:
            stamp = head_stamp(data, _COUNT_BYTES)
        if type_name == CLOCK_TYPE:
            self._clock = max(self._clock, stamp)
        time = max(stamp or self._clock, self._last.get(topic, 0))
        self._last[topic] = time
        return time


def head_stamp(data: bytes, offset: int = 0) -> int:
    """Return the time a serialised message begins with, ns; 0 if there is none or it is negative.

    Parameters
    ----------
    data : bytes
        CDR of a type whose first field is a ``std_msgs/Header`` or a ``builtin_interfaces/Time``.
    offset : int
        What comes before that field, bytes.
    """
    begin = _ENCAPSULATION_BYTES + offset
    if len(data) < begin + 8:
        return 0
    order = "<" if data[1] & 1 else ">"
    seconds, nanoseconds = struct.unpack_from(order + "iI", data, begin)
    return max(int(seconds) * NANOSECONDS + int(nanoseconds), 0)


def begins_with_header(definition_text: str) -> bool:
    """Return whether the first field of a ``.msg`` definition is a ``std_msgs/Header``."""
    for line in definition_text.splitlines():
        words = line.split("#", 1)[0].split()
        if len(words) < 2 or "=" in words[1] or "=" in "".join(words[2:3]):
            continue
        return words[0] in ("std_msgs/Header", "std_msgs/msg/Header", "Header")
    return False
