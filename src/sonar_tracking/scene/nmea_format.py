"""What every sentence of NMEA 0183 has in common: its checksum, and units of the sea."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from operator import xor

NAUTICAL_MILE = 1852.0
"""m."""

KNOT = NAUTICAL_MILE / 3600.0
"""m/s."""


def checksum(codes: Iterable[int]) -> str:
    """Return the exclusive or of the characters between ``$`` and ``*``, two digits."""
    return f"{reduce(xor, codes, 0):02X}"


def with_checksum(body: str) -> str:
    """Return a whole sentence: what stands between ``$`` and ``*``, and its checksum."""
    return f"${body}*{checksum(body.encode('ascii'))}"
