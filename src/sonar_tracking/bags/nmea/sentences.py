r"""Sentences of NMEA 0183 in lines of bytes, as a serial line, a log or a datagram holds them.

``$TTFFF,field,field*hh``: two letters of the talker, three of the format, and the exclusive or of
all between. Encapsulated ones (AIS) begin with ``!``. A logger may have written something ahead,
and a TAG block (``\c:1767225600*hh\``) tells when a sentence was heard.

References
----------
International Electrotechnical Commission (2016). IEC 61162-1, edition 5.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from itertools import pairwise

from sonar_tracking.errors import InputError
from sonar_tracking.scene.nmea_format import checksum

LONGEST = 1000
"""Bytes of a line that can be a sentence with what a logger writes ahead; the rest is another."""

NO_SENTENCE = "no sentence of NMEA 0183 ($ or !, and a checksum after *)"
NO_CHECKSUM = "the sentence has no checksum, as one that was cut off; it is not used"
WRONG_CHECKSUM = "the checksum is wrong; the sentence is not used"
NO_FORMAT = "the sentence has no talker and format; it is not used"

_SENTENCE = re.compile(rb"([$!])([\x20-\x7e]*?)\*([0-9A-Fa-f]{2})(?![0-9A-Fa-f])")
_BEGIN = re.compile(rb"[$!][A-Z]{5},")
_ADDRESS = re.compile(r"[A-Z0-9]{2}[A-Z]{3}|P[A-Z0-9]{3,}")
_TAG = re.compile(rb"\\([\x20-\x5b\x5d-\x7e]*)\*([0-9A-Fa-f]{2})\\")
_TAG_TIME = re.compile(rb"(?:^|,)c:(\d{9,14})(?:,|$)")
_BETWEEN = re.compile(rb"(?<=\*[0-9A-Fa-f]{2})(?!\\)(?=[^$!]*[$!])")
_MILLISECONDS = 1e11
"""Times since 1970 beyond this are not in seconds."""


@dataclass(frozen=True)
class Sentence:
    """One sentence whose checksum is right.

    Attributes
    ----------
    talker : str
        Two letters; ``P`` of a proprietary sentence.
    format : str
        Three letters, e.g. ``GGA``; the maker's of a proprietary one.
    fields : tuple of str
        What stands between the commas after it.
    heard : float
        When it was heard, by its TAG block, s since 1970; NaN = unknown.
    """

    talker: str
    format: str
    fields: tuple[str, ...]
    heard: float = math.nan

    def field(self, index: int) -> str:
        """Return a field; empty where the sentence has fewer."""
        return self.fields[index].strip() if index < len(self.fields) else ""


def lines_of(data: bytes) -> list[bytes]:
    """Return the lines of some bytes without their ends, each with one sentence at most."""
    return [part for line in data.splitlines() for part in parts_of(line)]


def parts_of(line: bytes) -> list[bytes]:
    """Return the parts of a line, each with one sentence at most; none of an empty line."""
    return [
        part
        for begin in range(0, len(line), LONGEST)
        for together in _BETWEEN.split(line[begin : begin + LONGEST])
        for part in _cut_apart(together)
        if part.strip()
    ]


def _cut_apart(line: bytes) -> list[bytes]:
    """Return a sentence that was cut off, and the one that goes on in its line, as two."""
    begins = [found.start() for found in _BEGIN.finditer(line)][1:]
    # Behind a TAG block begins the sentence that it belongs to.
    places = [0, *(place for place in begins if line[place - 1 : place] != b"\\"), len(line)]
    return [line[a:b] for a, b in pairwise(places)]


def read_sentence(line: bytes) -> Sentence:
    """Return the sentence of a line, whatever was cut off ahead of it.

    Parameters
    ----------
    line : bytes
        With or without its end.

    Raises
    ------
    InputError
        If it holds none that can be used; with the same words for all lines of one kind.
    """
    found = _SENTENCE.search(line)
    if found is None:
        raise InputError(NO_CHECKSUM if _BEGIN.search(line) else NO_SENTENCE)
    body = _after_the_last_begin(found[2])
    if checksum(body) != found[3].decode("ascii").upper():
        raise InputError(WRONG_CHECKSUM)
    address, _, rest = body.decode("ascii").partition(",")
    if not _ADDRESS.fullmatch(address):
        raise InputError(NO_FORMAT)
    split = 1 if address.startswith("P") else 2
    fields = tuple(rest.split(",")) if rest else ()
    return Sentence(address[:split], address[split:], fields, _heard(line[: found.start()]))


def _after_the_last_begin(body: bytes) -> bytes:
    """Return a sentence without what was cut off ahead of it in the same line."""
    last = max(body.rfind(b"$"), body.rfind(b"!"))
    return body[last + 1 :]


def _heard(ahead: bytes) -> float:
    """Return the time in the TAG block ahead of a sentence, s since 1970."""
    block = _TAG.search(ahead)
    if block is None or checksum(block[1]) != block[2].decode("ascii").upper():
        return math.nan
    told = _TAG_TIME.search(block[1])
    if told is None:
        return math.nan
    time = float(told[1])
    return time / 1000.0 if time > _MILLISECONDS else time
