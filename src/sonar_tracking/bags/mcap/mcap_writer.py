"""MCAP files written so that a kill loses little: small chunks, handed to the system on demand.

The file is an ordinary indexed MCAP (profile ``ros2``). Schemas and channels stand before the
chunks, so that every chunk that reached the disk can be read without the rest of the file. Chunks
are not compressed: sensor data do not compress, and the whole messages of a chunk that was cut
off can still be read. Every record that matters has a checksum of its own
(:mod:`~sonar_tracking.bags.mcap.mcap_checksums`), every chunk and the whole file those of MCAP.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from sonar_tracking.bags.mcap.mcap_checksums import RecordChecksum, checksums_record

MAGIC = b"\x89MCAP0\r\n"
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
"""Opcode, length, channel, sequence, log time, publish time of a message record."""

CHUNK_BYTES = 1 << 20
"""A chunk is closed once it holds this much."""


class McapWriter:
    """Writes one MCAP file.

    Parameters
    ----------
    path : Path
        File to make; it must not exist.
    library : str
        Name of the writing program, as the file tells it.
    """

    def __init__(self, path: Path, library: str) -> None:
        self._file: BinaryIO = path.open("xb")
        self._position = 0
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._metadata_indexes: list[MetadataIndex] = []
        self._chunk_indexes: list[ChunkIndex] = []
        self._counts: dict[int, int] = {}
        self._times: tuple[int, int] | None = None
        self._data_checksum = 0
        self._parts: list[bytes] = []
        self._checksums: list[RecordChecksum] = []
        self._chunk_size = 0
        self._message_indexes: dict[int, list[tuple[int, int]]] = {}
        self._write(MAGIC)
        self._write_record(Header("ros2", library))

    @property
    def pending_messages(self) -> int:
        """Messages not yet handed to the system."""
        return sum(len(index) for index in self._message_indexes.values())

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record (names and texts)."""
        self._finish_chunk()
        start, length = self._write_checked(Metadata(name=name, metadata=dict(values)))
        self._metadata_indexes.append(MetadataIndex(offset=start, length=length, name=name))

    def add_schema(self, name: str, encoding: str, text: str) -> int:
        """Write a schema record and return its number."""
        self._finish_chunk()
        schema = Schema(len(self._schemas) + 1, text.encode(), encoding, name)
        self._schemas.append(schema)
        self._write_checked(schema)
        return schema.id

    def add_channel(self, topic: str, schema: int, metadata: Mapping[str, str]) -> int:
        """Write a channel record for CDR messages and return its number."""
        self._finish_chunk()
        channel = Channel(
            id=len(self._channels) + 1,
            topic=topic,
            message_encoding="cdr",
            metadata=dict(metadata),
            schema_id=schema,
        )
        self._channels.append(channel)
        self._counts[channel.id] = 0
        self._write_checked(channel)
        return channel.id

    def add_message(self, channel: int, log_time: int, data: bytes) -> None:
        """Add one message to the chunk under construction.

        Parameters
        ----------
        channel : int
            Number from :meth:`add_channel`.
        log_time : int
            ns, not negative.
        data : bytes
            Serialised message, kept as it is.
        """
        sequence = self._counts[channel]
        head = MESSAGE_HEAD.pack(
            Opcode.MESSAGE, len(data) + 22, channel, sequence, log_time, log_time
        )
        self._message_indexes.setdefault(channel, []).append((log_time, self._chunk_size))
        self._parts += (head, data)
        length = len(head) + len(data)
        checksum = zlib.crc32(data, zlib.crc32(head))
        self._checksums.append(RecordChecksum(length, channel, checksum))
        self._chunk_size += length
        self._counts[channel] = sequence + 1
        if self._chunk_size >= CHUNK_BYTES:
            self._finish_chunk()

    def flush(self) -> None:
        """Close the chunk under construction and hand everything to the operating system."""
        self._finish_chunk()
        self._file.flush()

    def close(self) -> None:
        """Write the summary and close the file."""
        self._finish_chunk()
        self._write_record(DataEnd(self._data_checksum))
        summary_start = self._position
        summary = RecordBuilder()
        offsets = []
        groups: list[tuple[int, list[McapRecord]]] = [
            (Opcode.SCHEMA, [*self._schemas]),
            (Opcode.CHANNEL, [*self._channels]),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, [*self._chunk_indexes]),
            (Opcode.METADATA_INDEX, [*self._metadata_indexes]),
        ]
        for opcode, records in groups:
            start = summary.count
            for record in records:
                record.write(summary)
            if records:
                offsets.append(SummaryOffset(opcode, summary_start + start, summary.count - start))
        offset_start = summary_start + summary.count
        for offset in offsets:
            offset.write(summary)
        data = summary.end()
        footer_head = struct.pack("<BQQQ", Opcode.FOOTER, 20, summary_start, offset_start)
        self._write(data)
        self._write_record(
            Footer(
                summary_start=summary_start,
                summary_offset_start=offset_start,
                summary_crc=zlib.crc32(footer_head, zlib.crc32(data)),
            )
        )
        self._write(MAGIC)
        self._file.close()

    def _statistics(self) -> Statistics:
        first, last = self._times or (0, 0)
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self._counts),
            chunk_count=len(self._chunk_indexes),
            message_count=sum(self._counts.values()),
            metadata_count=len(self._metadata_indexes),
            message_start_time=first,
            message_end_time=last,
            schema_count=len(self._schemas),
        )

    def _finish_chunk(self) -> None:
        if not self._parts:
            return
        if not self._chunk_indexes:
            self._repeat_descriptions()
        self._write(checksums_record(self._checksums))
        data = self._parts[0] if len(self._parts) == 1 else b"".join(self._parts)
        times = [time for index in self._message_indexes.values() for time, _ in index]
        first, last = min(times), max(times)
        start = self._position
        length = self._write_chunk(data, first, last)
        index_start = self._position
        index_offsets = {}
        for channel, records in self._message_indexes.items():
            index_offsets[channel] = self._position
            self._write_record(MessageIndex(channel, records))
        self._chunk_indexes.append(
            ChunkIndex(
                chunk_length=length,
                chunk_start_offset=start,
                compression="",
                compressed_size=len(data),
                message_end_time=last,
                message_index_length=self._position - index_start,
                message_index_offsets=index_offsets,
                message_start_time=first,
                uncompressed_size=len(data),
            )
        )
        known = self._times or (first, last)
        self._times = (min(known[0], first), max(known[1], last))
        self._parts, self._checksums = [], []
        self._chunk_size, self._message_indexes = 0, {}

    def _repeat_descriptions(self) -> None:
        """Write schemas and channels once more: a killed recorder leaves no summary with them."""
        for record in (*self._schemas, *self._channels):
            self._write_checked(record)

    def _write_chunk(self, data: bytes, first: int, last: int) -> int:
        """Write a chunk record without copying the data once more; return its length."""
        empty = RecordBuilder()
        Chunk("", b"", last, first, zlib.crc32(data), len(data)).write(empty)
        head = bytearray(empty.end())
        struct.pack_into("<Q", head, 1, len(head) - 9 + len(data))
        struct.pack_into("<Q", head, len(head) - 8, len(data))
        self._write(bytes(head))
        self._write(data)
        return len(head) + len(data)

    def _write_checked(self, record: McapRecord) -> tuple[int, int]:
        """Write a record behind its checksum; return where it begins and its length."""
        data = _encoded(record)
        entry = RecordChecksum(len(data), 0, zlib.crc32(data))
        self._write(checksums_record([entry]))
        start = self._position
        self._write(data)
        return start, len(data)

    def _write_record(self, record: McapRecord) -> int:
        data = _encoded(record)
        self._write(data)
        return len(data)

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._position += len(data)
        self._data_checksum = zlib.crc32(data, self._data_checksum)


def _encoded(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()
