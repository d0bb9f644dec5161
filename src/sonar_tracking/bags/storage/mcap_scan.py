"""Scanning of MCAP files from their beginning, whole or not.

The scan needs no footer and no index: it reads record after record and stops at the first that is
cut off or damaged. Whole messages of an uncompressed chunk that was cut off count as well.
"""

from __future__ import annotations

import io
import mmap
import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema

from sonar_tracking.bags.storage.decompression import (
    LARGEST_CHUNK,
    DamagedDataError,
    TooLargeError,
    decompressed,
)
from sonar_tracking.bags.storage.mcap_writer import MAGIC, MESSAGE_HEAD
from sonar_tracking.bags.storage.storage_file import UnreadableFileError

_RECORD_HEAD = struct.Struct("<BQ")
_CHUNK_HEAD = struct.Struct("<QQQI")
_FIRST_PRIVATE_OPCODE = 0x80
_LOOSE_MESSAGES = 1000
"""Most messages outside of chunks that are put in order at once."""
_MESSAGE_FIELDS = MESSAGE_HEAD.size - _RECORD_HEAD.size

Buffer = bytes | mmap.mmap


class MessagePlace(NamedTuple):
    """Where one message is.

    Attributes
    ----------
    log_time : int
        ns.
    channel : int
        Channel number.
    start, length : int
        Bytes of the message, in the file or in the decompressed chunk.
    """

    log_time: int
    channel: int
    start: int
    length: int


@dataclass
class MessageRun:
    """Messages that follow one another: those of a chunk, or some outside of chunks.

    Attributes
    ----------
    chunk : int
        Index into ``compressed_chunks`` of the scan; -1 = in the file itself.
    start, end : int
        Their records, in the file or in the decompressed chunk, bytes.
    first : int
        Earliest log time, ns.
    counts : dict
        Number of messages by channel number.
    """

    chunk: int
    start: int
    end: int
    first: int = 0
    counts: dict[int, int] = field(default_factory=dict)


class CompressedChunk(NamedTuple):
    """Records of a compressed chunk: compression, place in the file, and their size once whole."""

    compression: str
    start: int
    length: int
    size: int


@dataclass
class McapScan:
    """What a file holds.

    Attributes
    ----------
    name : str
        Name of the file, for errors.
    data : bytes or mmap
        What is in it.
    schemas, channels : dict
        By number.
    metadata : dict
        Metadata records by name.
    runs : list of MessageRun
        All whole messages, in file order.
    compressed_chunks : list of CompressedChunk
        Where the records of each are.
    complete : bool
        True where the file ends as it should.
    damage : str
        Why the scan stopped early; empty where it did not.
    """

    name: str
    data: Buffer
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    runs: list[MessageRun] = field(default_factory=list)
    compressed_chunks: list[CompressedChunk] = field(default_factory=list)
    complete: bool = False
    damage: str = ""


class _DamageError(Exception):
    """The scan cannot go on; the text says why."""


def scan_mcap(path: Path, name: str) -> McapScan:
    """Read the structure of an MCAP file; the messages stay on the disk.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        What to call it in errors.

    Raises
    ------
    UnreadableFileError
        If the file cannot be opened or does not begin as an MCAP file.
    ConfigurationError
        If it is compressed and cannot be decompressed here.
    """
    try:
        with path.open("rb") as file:
            size = file.seek(0, io.SEEK_END)
            data: Buffer = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) if size else b""
    except OSError as error:
        raise UnreadableFileError(f"{name} cannot be read ({error.strerror}).") from error
    if not size:
        raise UnreadableFileError(f"{name} is empty; nothing was recorded.")
    if data[: len(MAGIC)] != MAGIC[:size]:
        raise UnreadableFileError(
            f"{name} is not an MCAP file; give a rosbag2 directory or a file that ends in .mcap."
        )
    scan = McapScan(name, data)
    try:
        _scan_records(scan)
    except _DamageError as reason:
        scan.damage = str(reason)
    return scan


def places_of(scan: McapScan, run: MessageRun) -> tuple[Buffer, list[MessagePlace]]:
    """Return the messages of a run in log order, and the data they lie in.

    Messages of equal log time are in the order of recording.

    Raises
    ------
    ConfigurationError
        If the library that decompresses them is not installed.
    """
    data = scan.data if run.chunk < 0 else _chunk_records(scan, scan.compressed_chunks[run.chunk])
    places, position = [], run.start
    while position < run.end:
        opcode, length = _RECORD_HEAD.unpack_from(data, position)
        if opcode == Opcode.MESSAGE and length >= _MESSAGE_FIELDS:
            _, _, channel, _, log_time, _ = MESSAGE_HEAD.unpack_from(data, position)
            start = position + MESSAGE_HEAD.size
            places.append(MessagePlace(log_time, channel, start, length - _MESSAGE_FIELDS))
        position += _RECORD_HEAD.size + length
    places.sort(key=lambda place: place.log_time)
    return data, places


def _chunk_records(scan: McapScan, chunk: CompressedChunk) -> bytes:
    """Return the records of a compressed chunk."""
    data = scan.data[chunk.start : chunk.start + chunk.length]
    what = f"a chunk of {scan.name}"
    if chunk.size > LARGEST_CHUNK:
        raise TooLargeError(
            f"{what} would decompress to {chunk.size >> 20} MiB, more than "
            f"{LARGEST_CHUNK >> 20} MiB; record it again with smaller chunks."
        )
    try:
        return decompressed(data, chunk.compression, chunk.size, what)
    except (DamagedDataError, TooLargeError) as error:
        raise _DamageError(
            f"a compressed chunk at byte {chunk.start} cannot be decompressed"
        ) from error


def _scan_records(scan: McapScan) -> None:
    data, position, size = scan.data, len(MAGIC), len(scan.data)
    loose: MessageRun | None = None
    while True:
        if size - position < _RECORD_HEAD.size:
            raise _DamageError(f"it ends at byte {size} without its closing part")
        opcode, length = _RECORD_HEAD.unpack_from(data, position)
        body = position + _RECORD_HEAD.size
        end = body + length
        if opcode == Opcode.CHUNK:
            loose = None
            _scan_chunk(scan, body, length)
        elif end > size:
            raise _DamageError(f"it ends at byte {size} in the middle of a record")
        elif opcode == Opcode.MESSAGE:
            if loose is None or sum(loose.counts.values()) >= _LOOSE_MESSAGES:
                loose = MessageRun(-1, position, position)
            _scan_messages(scan, data, position, end, loose)
        else:
            _scan_small_record(scan, opcode, data[body:end], position)
        if opcode == Opcode.FOOTER:
            if data[end : end + len(MAGIC)] != MAGIC:
                raise _DamageError(f"it ends at byte {size} without its closing part")
            scan.complete = True
            return
        position = end


def _scan_small_record(scan: McapScan, opcode: int, payload: bytes, position: int) -> None:
    """Take up a record that is neither chunk nor message; ``position`` is where it begins."""
    if opcode == 0 or Opcode.DATA_END < opcode < _FIRST_PRIVATE_OPCODE:
        raise _DamageError(f"there is no MCAP record at byte {position}")
    if opcode not in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA):
        return
    stream = ReadDataStream(io.BytesIO(payload))
    try:
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            scan.schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            scan.channels[channel.id] = channel
        else:
            record = Metadata.read(stream)
            scan.metadata[record.name] = record.metadata
    except (McapError, struct.error, UnicodeDecodeError) as error:
        raise _DamageError(f"the record at byte {position} is damaged") from error


def _scan_chunk(scan: McapScan, body: int, length: int) -> None:
    """Scan a chunk; raise :class:`_DamageError` after its whole messages if it is cut off."""
    data, size = scan.data, len(scan.data)
    cut_off = _DamageError(f"it ends at byte {size} in the middle of a chunk")
    if size - body < _CHUNK_HEAD.size + 4:
        raise cut_off
    _, _, whole_size, checksum = _CHUNK_HEAD.unpack_from(data, body)
    (name_length,) = struct.unpack_from("<I", data, body + _CHUNK_HEAD.size)
    name_start = body + _CHUNK_HEAD.size + 4
    start = name_start + name_length + 8
    if start > size:
        raise cut_off
    compression = data[name_start : start - 8].decode("ascii", "replace")
    (records_length,) = struct.unpack_from("<Q", data, start - 8)
    end = start + records_length
    if end > body + length or compression not in ("", "lz4", "zstd"):
        raise _DamageError(f"the chunk at byte {body - _RECORD_HEAD.size} is damaged")
    if not compression:
        whole = end <= size
        if whole and checksum and zlib.crc32(memoryview(data)[start:end]) != checksum:
            raise _DamageError(f"the chunk at byte {body - _RECORD_HEAD.size} is damaged")
        _scan_messages(scan, data, start, min(end, size), MessageRun(-1, start, start))
        if not whole:
            raise cut_off
        return
    if end > size:
        raise cut_off
    chunk = CompressedChunk(compression, start, records_length, whole_size)
    records = _chunk_records(scan, chunk)
    if checksum and zlib.crc32(records) != checksum:
        raise _DamageError(f"the chunk at byte {body - _RECORD_HEAD.size} is damaged")
    scan.compressed_chunks.append(chunk)
    run = MessageRun(len(scan.compressed_chunks) - 1, 0, 0)
    _scan_messages(scan, records, 0, len(records), run)


def _scan_messages(scan: McapScan, data: Buffer, start: int, end: int, run: MessageRun) -> None:
    """Add the messages that lie wholly before ``end`` to a run."""
    position = start
    while end - position >= _RECORD_HEAD.size:
        opcode, length = _RECORD_HEAD.unpack_from(data, position)
        body = position + _RECORD_HEAD.size
        if body + length > end:
            return
        if opcode == Opcode.MESSAGE and length >= _MESSAGE_FIELDS:
            _, _, channel, _, log_time, _ = MESSAGE_HEAD.unpack_from(data, position)
            if channel not in scan.channels:
                raise _DamageError(f"a message at byte {position} belongs to no topic")
            if not run.counts:
                run.first = log_time
                scan.runs.append(run)
            run.first = min(run.first, log_time)
            run.counts[channel] = run.counts.get(channel, 0) + 1
            run.end = body + length
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            _scan_small_record(scan, opcode, data[body : body + length], position)
        position = body + length
