"""Checksums of single records, which MCAP itself does not know.

MCAP keeps a CRC-32 of each chunk and of the whole file: they tell that something is damaged, not
what. Before each chunk, and before each record outside of chunks that matters, our files therefore
hold a record of a private opcode with the checksum of every record that follows, so that of a chunk
with a damaged byte one message is lost. Other readers pass over private records.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from collections.abc import Sequence
from typing import NamedTuple

OPCODE = 0xC3
TAG = b"sonarCRC"
"""First bytes of the content; they are looked for where the sequence of records is lost."""

_HEAD = struct.Struct("<BQ8sI")
_ENTRY = struct.Struct("<IHI")
_MOST_ENTRIES = 1 << 16
"""More than the messages of a chunk, even of those without content."""

Buffer = bytes | mmap.mmap


class RecordChecksum(NamedTuple):
    """What is known of one record.

    Attributes
    ----------
    length : int
        With opcode and length, bytes.
    channel : int
        Channel number of a message; 0 = the record stands outside of chunks.
    checksum : int
        CRC-32 of all its bytes.
    """

    length: int
    channel: int
    checksum: int

    def fits(self, data: Buffer, start: int) -> bool:
        """Return whether the record stands at ``start``, byte for byte."""
        end = start + self.length
        return end <= len(data) and zlib.crc32(data[start:end]) == self.checksum


def checksums_record(entries: Sequence[RecordChecksum]) -> bytes:
    """Return the record that stands before those it speaks of."""
    content = b"".join(_ENTRY.pack(*entry) for entry in entries)
    length = _HEAD.size - 9 + len(content)
    return _HEAD.pack(OPCODE, length, TAG, zlib.crc32(content)) + content


def read_checksums(data: Buffer, start: int) -> list[RecordChecksum] | None:
    """Return the checksums in the record at ``start``; None where there is none, or it is damaged.

    Parameters
    ----------
    data : bytes or mmap
        The file.
    start : int
        Where the record begins.
    """
    if start + _HEAD.size > len(data):
        return None
    opcode, length, tag, checksum = _HEAD.unpack_from(data, start)
    if (opcode, tag) != (OPCODE, TAG) or length > _HEAD.size + _MOST_ENTRIES * _ENTRY.size:
        return None
    content = data[start + _HEAD.size : min(start + 9 + length, len(data))]
    if zlib.crc32(content) != checksum:
        return None
    if len(content) % _ENTRY.size:
        return None
    return [RecordChecksum(*entry) for entry in _ENTRY.iter_unpack(content)]
