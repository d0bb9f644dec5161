"""Where the next record of a damaged MCAP file begins."""

from __future__ import annotations

import re
from collections.abc import Callable

from mcap.opcode import Opcode

from sonar_tracking.bags.mcap.mcap_checksums import OPCODE, TAG, Buffer, read_checksums
from sonar_tracking.bags.mcap.mcap_chunks import DamageError, chunk_at
from sonar_tracking.bags.mcap.mcap_summary import RECORD_HEAD, McapSummary

_CHUNK = re.compile(
    rb"\x06.{5}\x00\x00\x00.{21}\x00\x00\x00.{4}(?:\x00{4}|\x03\x00{3}lz4|\x04\x00{3}zstd)",
    re.DOTALL,
)
_CHECKSUMS = re.compile(re.escape(bytes([OPCODE])) + rb".{8}" + re.escape(TAG), re.DOTALL)
_DATA_END = re.compile(rb"\x0f\x04\x00{7}.{4}[\x02-\x0e].{4}\x00{4}", re.DOTALL)
_MESSAGE = re.compile(rb"\x05.{4}\x00{4}", re.DOTALL)


class Resynchronisation:
    """Finds the next record; asked for places that only grow, it reads the file once.

    Parameters
    ----------
    data : bytes or mmap
        The file.
    limit : int
        Where its data end, bytes.
    summary : McapSummary
        What its closing part says.
    """

    def __init__(self, data: Buffer, limit: int, summary: McapSummary) -> None:
        self._data = data
        self._limit = limit
        known = [*summary.chunks, *summary.metadata]
        if summary.verified:
            known.append(summary.data_end)
        self._known = sorted(known, reverse=True)
        self._chunks = _Search(_CHUNK, data, self._is_chunk)
        self._checksums = _Search(_CHECKSUMS, data, lambda at: bool(read_checksums(data, at)))
        self._ends = _Search(_DATA_END, data, lambda at: True)
        self._messages = _Search(_MESSAGE, data, lambda at: self.are_records(at, 3))

    def next_record(self, position: int, loose_messages: bool) -> int | None:
        """Return where the next record begins that can be told from chance; None = nowhere.

        Parameters
        ----------
        position : int
            Not before this byte.
        loose_messages : bool
            Whether messages may stand outside of chunks.
        """
        while self._known and self._known[-1] < position:
            self._known.pop()
        found = [search.at(position) for search in (self._chunks, self._checksums, self._ends)]
        if loose_messages and self._chunks.at(0) is None:
            found.append(self._messages.at(position))
        found += self._known[-1:]
        return min((at for at in found if at is not None), default=None)

    def is_record(self, position: int) -> bool:
        """Return whether a record may begin here, or the data end before that can be told."""
        if self._limit - position < RECORD_HEAD.size:
            return position <= self._limit
        opcode, length = RECORD_HEAD.unpack_from(self._data, position)
        return (0 < opcode <= Opcode.DATA_END or opcode == OPCODE) and length < 1 << 40

    def are_records(self, position: int, count: int) -> bool:
        """Return whether some records follow one another from here, or up to where data end."""
        for _ in range(count):
            if position == self._limit:
                return True
            if not self.is_record(position) or self._limit - position < RECORD_HEAD.size:
                return False
            position += RECORD_HEAD.size + RECORD_HEAD.unpack_from(self._data, position)[1]
        return position <= self._limit

    def _is_chunk(self, position: int) -> bool:
        try:
            chunk = chunk_at(self._data, position)
        except DamageError:
            return False
        return chunk.end <= self._limit and self.is_record(chunk.end)


class _Search:
    """Matches of a pattern, one after another, the last one remembered."""

    def __init__(self, pattern: re.Pattern[bytes], data: Buffer, check: Callable[[int], bool]):
        self._pattern = pattern
        self._data = data
        self._check = check
        self._found: int | None = -1

    def at(self, position: int) -> int | None:
        """Return the first match from ``position`` on; for an earlier one than before, that."""
        while self._found is not None and self._found < position:
            match = self._pattern.search(self._data, max(self._found + 1, position))
            self._found = match.start() if match else None
            if match and not self._check(match.start()):
                position = max(position, match.start() + 1)
        return self._found
