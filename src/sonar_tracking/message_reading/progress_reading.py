"""Reports on ``flow/done`` from bytes, a third of the time of making a message of each."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from sonar_tracking.errors import InputError
from sonar_tracking.message_reading.cdr_reading import ENCAPSULATION, aligned, byte_order
from sonar_tracking.records.time import NANOSECONDS


@dataclass(frozen=True, slots=True)
class ProgressReport:
    """What a node has done with one of its topics.

    Attributes
    ----------
    node, topic : str
        Name of the node as its run knows it, and of the topic.
    count : int
        Messages published or finished.
    stamp : int
        Of the last of them, ns.
    """

    node: str
    topic: str
    count: int
    stamp: int


def progress_from_bytes(data: bytes) -> ProgressReport:
    """Return the report a serialised ``Progress`` message carries.

    Parameters
    ----------
    data : bytes
        CDR with its encapsulation header.

    Raises
    ------
    InputError
        If the bytes are no such message.
    """
    try:
        order = byte_order(data)
        seconds, nanoseconds, frame = struct.unpack_from(order + "iII", data, ENCAPSULATION)
        begin = aligned(ENCAPSULATION + 12 + frame, 4) + 8
        node, begin = _text(data, begin, order)
        topic, begin = _text(data, aligned(begin, 4), order)
        (count,) = struct.unpack_from(order + "Q", data, aligned(begin, 8))
    except (struct.error, UnicodeDecodeError, IndexError) as error:
        raise InputError(f"{len(data)} bytes are not a message of Progress ({error}).") from error
    return ProgressReport(node, topic, count, seconds * NANOSECONDS + nanoseconds)


def _text(data: bytes, begin: int, order: str) -> tuple[str, int]:
    """Return a text and where it ends."""
    (length,) = struct.unpack_from(order + "I", data, begin)
    end = begin + 4 + length
    return data[begin + 4 : end - 1].decode(), end
