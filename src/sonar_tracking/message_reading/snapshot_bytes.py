"""Blocks of snapshots from bytes: what they have in common with the block before is read once.

The blocks of an array differ in their stamps and their data. To make a message of each, field by
field, and to read and check all of them again takes longer than to count the sources in it.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.message_reading.array_reading import snapshots_from_message
from sonar_tracking.message_reading.cdr_reading import (
    ENCAPSULATION,
    aligned,
    byte_order,
    end_of_text,
)
from sonar_tracking.message_reading.field_limits import LIMITS
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.records.time import NANOSECONDS

_TIME = struct.Struct("<iI")
_STAMP = ENCAPSULATION
_SENSOR_AND_REALS = 10 + 4
"""Numbers between the name of the sensor and the positions of the elements."""
_COLUMNS = 3


@dataclass(frozen=True)
class _Known:
    """A block that was read, and where its bytes are.

    Attributes
    ----------
    record : ArraySnapshots
        What it holds.
    next_stamp, data, end : int
        Where its next stamp and its data begin, and where these end.
    parts : tuple of bytes
        All of it but stamps and data.
    """

    record: ArraySnapshots
    next_stamp: int
    data: int
    end: int
    parts: tuple[bytes, ...]


class SnapshotBytes:
    """Reads the blocks of one topic, serialised or not."""

    def __init__(self) -> None:
        self._known: _Known | None = None

    def __call__(self, message: Any) -> ArraySnapshots:
        """Return the block that a message carries."""
        return snapshots_from_message(message)

    def record(self, block: bytes) -> ArraySnapshots | None:
        """Return the record of a block that differs from the last one in stamps and data alone.

        Parameters
        ----------
        block : bytes
            CDR with its encapsulation header.

        Returns
        -------
        ArraySnapshots or None
            None = it has to be read as a message.
        """
        known = self._known
        if known is None or _parts(block, known.next_stamp, known.data, known.end) != known.parts:
            return None
        reals = np.frombuffer(block, np.float32, (known.end - known.data) // 4, known.data)
        # Not the absolute values: NaN and infinity are for the stage to judge, as in a message.
        if reals.size == 0 or reals.max() > LIMITS["data"][0] or reals.min() < -LIMITS["data"][0]:
            return None
        return replace(
            known.record,
            stamp=_time(block, _STAMP),
            next_stamp=_time(block, known.next_stamp),
            data=reals.view(np.complex64).reshape(known.record.data.shape).astype(np.complex128),
        )

    def learn(self, block: bytes, record: ArraySnapshots) -> None:
        """Take a block that was read as a message for the one that others are compared with."""
        self._known = None
        try:
            next_stamp, data = _places(block)
        except (struct.error, IndexError):
            return
        end = data + 8 * record.data.size
        if byte_order(block) == "<" and _time(block, next_stamp) == record.next_stamp:
            self._known = _Known(
                record, next_stamp, data, end, _parts(block, next_stamp, data, end)
            )


def _parts(block: bytes, next_stamp: int, data: int, end: int) -> tuple[bytes, ...]:
    before, between = block[_STAMP + _TIME.size : next_stamp], block[next_stamp + _TIME.size : data]
    return block[:_STAMP], before, between, block[end:]


def _places(block: bytes) -> tuple[int, int]:
    """Return where the next stamp and the data of a block begin."""
    order = byte_order(block)
    next_stamp = aligned(end_of_text(block, _STAMP + _TIME.size, order), 4)
    place = aligned(end_of_text(block, next_stamp + _TIME.size, order), 8) + 8 * _SENSOR_AND_REALS
    for _ in range(_COLUMNS):
        place = aligned(place, 4)
        (length,) = struct.unpack_from(order + "I", block, place)
        place = aligned(place + 4, 8) + 8 * length
    return next_stamp, place + 4 + 4


def _time(block: bytes, place: int) -> int:
    seconds, nanoseconds = _TIME.unpack_from(block, place)
    return int(seconds) * NANOSECONDS + int(nanoseconds)
