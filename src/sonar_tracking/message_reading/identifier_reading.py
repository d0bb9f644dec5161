"""Stamp and identifiers of serialised track lists, a fifteenth of the time of decoding them."""

from __future__ import annotations

import struct

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.message_reading.cdr_reading import (
    ENCAPSULATION,
    aligned,
    byte_order,
    end_of_text,
)
from sonar_tracking.records.arrays import IdArray

_POSE_AND_VELOCITY = 10 * 8
"""Bytes of a pose and a vector."""


def bearing_identifiers(data: bytes) -> IdArray:
    """Return the identifiers in a serialised ``BearingTracks``, shape (n_tracks,).

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
        begin = end_of_text(data, _end_of_head(data, order), order)
        kind = aligned(begin, 8) + _POSE_AND_VELOCITY
        return _identifiers(data, kind + 1, order)
    except (struct.error, ValueError, IndexError) as error:
        raise InputError(f"{len(data)} bytes are no list of bearing tracks ({error}).") from error


def position_identifiers(data: bytes) -> IdArray:
    """Return the identifiers in a serialised ``Tracks``, shape (n_tracks,).

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
        return _identifiers(data, _end_of_head(data, order), order)
    except (struct.error, ValueError, IndexError) as error:
        raise InputError(f"{len(data)} bytes are no list of position tracks ({error}).") from error


def _end_of_head(data: bytes, order: str) -> int:
    """Return where header and next stamp end."""
    return aligned(end_of_text(data, ENCAPSULATION + 8, order), 4) + 8


def _identifiers(data: bytes, begin: int, order: str) -> IdArray:
    begin = aligned(begin, 4)
    (count,) = struct.unpack_from(order + "I", data, begin)
    begin = aligned(begin + 4, 8) if count else begin + 4
    found = np.frombuffer(data, order + "u8", count, begin)
    return found.astype(np.uint64, copy=False)
