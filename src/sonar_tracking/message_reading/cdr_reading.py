"""Where the fields of serialised messages begin (CDR, version 1)."""

from __future__ import annotations

import struct

ENCAPSULATION = 4
"""Bytes before the first field; positions are aligned as if they were not there."""


def byte_order(data: bytes) -> str:
    """Return the byte order of a message as :mod:`struct` writes it."""
    return "<" if data[1] & 1 else ">"


def aligned(position: int, size: int) -> int:
    """Return the next position at which a number of some size begins."""
    return position + (ENCAPSULATION - position) % size


def end_of_text(data: bytes, begin: int, order: str) -> int:
    """Return where a text ends that begins at the next multiple of 4."""
    begin = aligned(begin, 4)
    (length,) = struct.unpack_from(order + "I", data, begin)
    return int(begin + 4 + length)
