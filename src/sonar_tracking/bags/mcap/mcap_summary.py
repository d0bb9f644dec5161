"""The closing part of an MCAP file: copies of what stands in its head, and where its chunks are."""

from __future__ import annotations

import io
import struct
import zlib
from dataclasses import dataclass, field
from typing import TypeVar

from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Metadata, MetadataIndex, Schema, Statistics

from sonar_tracking.bags.mcap.mcap_checksums import Buffer
from sonar_tracking.bags.mcap.mcap_writer import MAGIC

RECORD_HEAD = struct.Struct("<BQ")
_FOOTER = struct.Struct("<BQQQI")
_INDEX_HEAD_BYTES, _INDEX_ENTRY_BYTES = 6, 16
_DATA_END = RECORD_HEAD.pack(Opcode.DATA_END, 4)
_DATA_END_BYTES = RECORD_HEAD.size + 4

SmallRecord = Schema | Channel | Metadata | ChunkIndex | MetadataIndex | Statistics
Kind = TypeVar("Kind", bound=SmallRecord)


@dataclass(frozen=True)
class McapSummary:
    """What the end of a file says of the rest.

    Attributes
    ----------
    closed : bool
        Whether the file ends as it should.
    verified : bool
        Whether there is a closing part, and its checksum fits.
    data_end : int
        Where the data end, bytes; the size of the file where that is not known.
    schemas, channels : dict
        By number.
    chunks : dict
        By where they begin, in that order; none where that is not where they were written.
    metadata : tuple of int
        Where the metadata records begin.
    message_counts : dict or None
        Messages by channel number; None = not stated.
    """

    closed: bool
    verified: bool
    data_end: int
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    chunks: dict[int, ChunkIndex] = field(default_factory=dict)
    metadata: tuple[int, ...] = ()
    message_counts: dict[int, int] | None = None


def read_summary(data: Buffer) -> McapSummary:
    """Return what the end of a file says; of one whose checksum does not fit, nothing."""
    size = len(data)
    footer = size - len(MAGIC) - _FOOTER.size
    nothing = McapSummary(data[-len(MAGIC) :] == MAGIC, False, size)
    if footer < len(MAGIC) or not nothing.closed:
        return nothing
    opcode, length, start, _, checksum = _FOOTER.unpack_from(data, footer)
    if (opcode, length) != (Opcode.FOOTER, _FOOTER.size - RECORD_HEAD.size):
        return McapSummary(False, False, size)
    if not checksum or not len(MAGIC) + _DATA_END_BYTES <= start <= footer:
        return nothing
    # Where bytes were inserted or lost before it, it does not begin where it says.
    moved = data.rfind(_DATA_END, 0, footer) + _DATA_END_BYTES
    for begin in (start, moved):
        if zlib.crc32(data[begin : footer + _FOOTER.size - 4]) == checksum:
            try:
                return _summary(data[begin:footer], begin - _DATA_END_BYTES, begin == start)
            except ValueError:
                return nothing
    return McapSummary(False, False, size)


def _summary(data: bytes, data_end: int, in_place: bool) -> McapSummary:
    found: dict[int, list[bytes]] = {}
    position = 0
    while len(data) - position >= RECORD_HEAD.size:
        opcode, length = RECORD_HEAD.unpack_from(data, position)
        position += RECORD_HEAD.size
        found.setdefault(opcode, []).append(data[position : position + length])
        position += length
    schemas = [parsed(Schema, content) for content in found.get(Opcode.SCHEMA, ())]
    channels = [parsed(Channel, content) for content in found.get(Opcode.CHANNEL, ())]
    chunks = [parsed(ChunkIndex, content) for content in found.get(Opcode.CHUNK_INDEX, ())]
    metadata = [parsed(MetadataIndex, content) for content in found.get(Opcode.METADATA_INDEX, ())]
    statistics = [parsed(Statistics, content) for content in found.get(Opcode.STATISTICS, ())]
    chunks.sort(key=lambda chunk: chunk.chunk_start_offset)
    return McapSummary(
        closed=True,
        verified=True,
        data_end=data_end,
        schemas={schema.id: schema for schema in schemas},
        channels={channel.id: channel for channel in channels},
        chunks={chunk.chunk_start_offset: chunk for chunk in chunks if in_place},
        metadata=tuple(sorted(index.offset for index in metadata if in_place)),
        message_counts=dict(statistics[0].channel_message_counts) if statistics else None,
    )


def parsed(kind: type[Kind], content: bytes) -> Kind:
    """Return the content of a record as what it is.

    Raises
    ------
    ValueError
        If it is not that, byte for byte.
    """
    try:
        record: Kind = kind.read(ReadDataStream(io.BytesIO(content)))
        builder = RecordBuilder()
        record.write(builder)
    except (McapError, struct.error, UnicodeDecodeError) as error:
        raise ValueError(f"it is no {kind.__name__} record") from error
    if builder.end()[RECORD_HEAD.size :] != content:
        raise ValueError(f"it is no {kind.__name__} record")
    return record


def check_content(opcode: int, content: bytes) -> None:
    """Refuse a message index of another size than it states, an attachment of another checksum.

    Raises
    ------
    ValueError
        If it is so.
    """
    if len(content) < _INDEX_HEAD_BYTES:
        raise ValueError("it is too short")
    if opcode == Opcode.MESSAGE_INDEX:
        (length,) = struct.unpack_from("<I", content, 2)
        if length != len(content) - _INDEX_HEAD_BYTES or length % _INDEX_ENTRY_BYTES:
            raise ValueError("it is no message index")
    elif opcode == Opcode.ATTACHMENT:
        (checksum,) = struct.unpack_from("<I", content, len(content) - 4)
        if checksum and zlib.crc32(content[:-4]) != checksum:
            raise ValueError("it has another checksum")
