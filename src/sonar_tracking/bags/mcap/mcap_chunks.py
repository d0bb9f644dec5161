"""Chunks of an MCAP file: where their records are, and whether they are what was written."""

from __future__ import annotations

import struct
import zlib
from typing import NamedTuple

from mcap.opcode import Opcode
from mcap.records import ChunkIndex

from sonar_tracking.bags.contents import decompression
from sonar_tracking.bags.mcap.mcap_checksums import Buffer
from sonar_tracking.bags.mcap.mcap_summary import RECORD_HEAD

_CHUNK_HEAD = struct.Struct("<QQQI")
_CHECKSUM_OFFSET = RECORD_HEAD.size + _CHUNK_HEAD.size - 4
_COMPRESSIONS = {b"": "", b"lz4": "lz4", b"zstd": "zstd"}
UNCOMPRESSED_HEAD_BYTES = RECORD_HEAD.size + _CHUNK_HEAD.size + 4 + 8
"""What stands before the records of a chunk that is not compressed."""


class DamageError(Exception):
    """What stands at a place is not what was written there; the text says why."""


class Chunk(NamedTuple):
    """A chunk.

    Attributes
    ----------
    compression : str
        ``""``, ``"lz4"`` or ``"zstd"``.
    start, length : int
        Its records as they stand in the file, bytes.
    size : int
        Their size once decompressed, bytes.
    checksum : int
        CRC-32 of the decompressed records; 0 = none.
    """

    compression: str
    start: int
    length: int
    size: int
    checksum: int

    @property
    def end(self) -> int:
        """Where the next record begins."""
        return self.start + self.length


def chunk_at(data: Buffer, position: int, index: ChunkIndex | None = None) -> Chunk:
    """Return the chunk whose record begins at ``position``; it may be cut off.

    Parameters
    ----------
    data : bytes or mmap
        The file.
    position : int
        Where the record begins.
    index : ChunkIndex, optional
        What a closing part that is whole says of it; it counts more than the head of the chunk.

    Raises
    ------
    DamageError
        If the head of the chunk is damaged or cut off.
    """
    if index is not None:
        start = position + UNCOMPRESSED_HEAD_BYTES + len(index.compression)
        (checksum,) = struct.unpack_from("<I", data, position + _CHECKSUM_OFFSET)
        return Chunk(
            index.compression, start, index.compressed_size, index.uncompressed_size, checksum
        )
    if len(data) - position < UNCOMPRESSED_HEAD_BYTES:
        raise DamageError(f"it ends at byte {len(data)} in the middle of a chunk")
    opcode, length = RECORD_HEAD.unpack_from(data, position)
    body = position + RECORD_HEAD.size
    _, _, size, checksum = _CHUNK_HEAD.unpack_from(data, body)
    (name_length,) = struct.unpack_from("<I", data, body + _CHUNK_HEAD.size)
    name_start = body + _CHUNK_HEAD.size + 4
    start = name_start + name_length + 8
    name = data[name_start : name_start + min(name_length, 5)]
    if opcode != Opcode.CHUNK or name not in _COMPRESSIONS or start > len(data):
        raise DamageError(f"the chunk at byte {position} is damaged")
    (records_length,) = struct.unpack_from("<Q", data, start - 8)
    if start + records_length != body + length:
        raise DamageError(f"the chunk at byte {position} is damaged")
    return Chunk(_COMPRESSIONS[name], start, records_length, size, checksum)


def chunk_records(data: Buffer, chunk: Chunk, name: str) -> bytes:
    """Return the records of a compressed chunk.

    Parameters
    ----------
    data : bytes or mmap
        The file.
    chunk : Chunk
        One of its chunks.
    name : str
        Of the file, for errors.

    Raises
    ------
    DamageError
        If they are not what was written.
    ConfigurationError
        If the library that decompresses them is not installed.
    """
    what = f"a chunk of {name}"
    if chunk.size > decompression.LARGEST_CHUNK:
        raise DamageError(
            f"{what} would decompress to {chunk.size >> 20} MiB, more than "
            f"{decompression.LARGEST_CHUNK >> 20} MiB; record it again with smaller chunks"
        )
    packed = data[chunk.start : chunk.end]
    try:
        records = decompression.decompressed(packed, chunk.compression, chunk.size, what)
    except (decompression.DamagedDataError, decompression.TooLargeError) as error:
        raise DamageError(
            f"a compressed chunk at byte {chunk.start} cannot be decompressed"
        ) from error
    if len(records) != chunk.size or (chunk.checksum and zlib.crc32(records) != chunk.checksum):
        raise DamageError(f"the compressed chunk at byte {chunk.start} is damaged")
    return records


def has_its_checksum(data: Buffer, chunk: Chunk) -> bool:
    """Return whether the records of a chunk that is not compressed have the checksum it states."""
    return (
        bool(chunk.checksum)
        and chunk.end <= len(data)
        and (zlib.crc32(memoryview(data)[chunk.start : chunk.end]) == chunk.checksum)
    )
