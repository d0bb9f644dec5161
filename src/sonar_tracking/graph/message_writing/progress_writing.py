"""Reports on ``flow/done`` as bytes: there are more of them than of all data together."""

from __future__ import annotations

import struct

from sonar_tracking.records.time import NANOSECONDS

_HEAD = struct.Struct("<4siI5s3xiI")
"""Encapsulation, stamp, empty frame, next stamp."""


class ProgressWriter:
    """Writes the ``Progress`` messages of one topic of a node as little-endian CDR.

    Parameters
    ----------
    node : str
        Name of the node as its run knows it.
    topic : str
        Resolved name.
    """

    def __init__(self, node: str, topic: str) -> None:
        names = b""
        for name in (node, topic):
            text = name.encode() + b"\0"
            names += b"\0" * (-len(names) % 4) + struct.pack("<I", len(text)) + text
        # Of the head 24 bytes count for the alignment, which is a multiple of that of a count.
        self._names = names + b"\0" * (-len(names) % 8)

    def message(self, count: int, stamp: int) -> bytes:
        """Return the serialised report of a number of messages up to a stamp, ns."""
        seconds, nanoseconds = divmod(stamp, NANOSECONDS)
        head = _HEAD.pack(b"\0\1\0\0", seconds, nanoseconds, b"\1\0\0\0\0", 0, 0)
        return head + self._names + count.to_bytes(8, "little")
