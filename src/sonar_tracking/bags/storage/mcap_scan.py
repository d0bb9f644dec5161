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

from sonar_tracking.bags.storage.mcap_writer import MAGIC, MESSAGE_HEAD
from sonar_tracking.errors import ConfigurationError

_RECORD_HEAD = struct.Struct("<BQ")
_CHUNK_HEAD = struct.Struct("<QQQI")
_FIRST_PRIVATE_OPCODE = 0x80
_MESSAGE_FIELDS = MESSAGE_HEAD.size - _RECORD_HEAD.size

Buffer = bytes | mmap.mmap


class MessagePlace(NamedTuple):
    """Where one message is.

    Attributes
    ----------
    channel : int
        Channel number.
    log_time : int
        ns.
    start, length : int
        Bytes of the message, in the file or in the decompressed chunk.
    chunk : int
        Index into ``compressed_chunks`` of the scan; -1 = in the file itself.
    """

    channel: int
    log_time: int
    start: int
    length: int
    chunk: int


@dataclass
class McapScan:
    """What a file holds.

    Attributes
    ----------
    data : bytes or mmap
        The file.
    schemas, channels : dict
        By number.
    metadata : dict
        Metadata records by name.
    places : list of MessagePlace
        All whole messages, in file order.
    compressed_chunks : list of tuple
        Compression, first byte and length of the records.
    complete : bool
        True where the file ends as it should.
    damage : str
        Why the scan stopped early; empty where it did not.
    """

    data: Buffer
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    places: list[MessagePlace] = field(default_factory=list)
    compressed_chunks: list[tuple[str, int, int]] = field(default_factory=list)
    complete: bool = False
    damage: str = ""


class _DamageError(Exception):
    """The scan cannot go on; the text says why."""


def scan_mcap(path: Path) -> McapScan:
    """Read the structure of an MCAP file; the messages stay on the disk.

    Raises
    ------
    ConfigurationError
        If the file cannot be opened or does not begin as an MCAP file.
    """
    try:
        with path.open("rb") as file:
            size = file.seek(0, io.SEEK_END)
            data: Buffer = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) if size else b""
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read ({error.strerror}).") from error
    if not size:
        raise ConfigurationError(f"{path} is empty; nothing was recorded.")
    if data[: len(MAGIC)] != MAGIC[:size]:
        raise ConfigurationError(
            f"{path} is not an MCAP file; give a rosbag2 directory or a file that ends in .mcap."
        )
    scan = McapScan(data)
    try:
        _scan_records(scan)
    except _DamageError as reason:
        scan.damage = str(reason)
    return scan


def decompressed(scan: McapScan, chunk: int) -> bytes:
    """Return the records of a compressed chunk.

    Raises
    ------
    ConfigurationError
        If the library that decompresses it is not installed or the data are damaged.
    """
    compression, start, length = scan.compressed_chunks[chunk]
    data = scan.data[start : start + length]
    try:
        if compression == "lz4":
            import lz4.frame  # type: ignore[import-untyped]

            return bytes(lz4.frame.decompress(data))
        from backports import zstd

        return zstd.decompress(data)
    except ImportError as error:
        raise ConfigurationError(
            f"The bag is compressed with {compression}; "
            f"pip install {'lz4' if compression == 'lz4' else 'backports.zstd'}."
        ) from error
    except Exception as error:
        raise _DamageError(f"a compressed chunk at byte {start} cannot be decompressed") from error


def _scan_records(scan: McapScan) -> None:
    data, position, size = scan.data, len(MAGIC), len(scan.data)
    while True:
        if size - position < _RECORD_HEAD.size:
            raise _DamageError(f"it ends at byte {size} without its closing part")
        opcode, length = _RECORD_HEAD.unpack_from(data, position)
        body = position + _RECORD_HEAD.size
        end = body + length
        if opcode == Opcode.CHUNK:
            _scan_chunk(scan, body, length)
        elif end > size:
            raise _DamageError(f"it ends at byte {size} in the middle of a record")
        elif opcode == Opcode.MESSAGE:
            _scan_messages(scan, data, position, end, -1)
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
    _, _, _, checksum = _CHUNK_HEAD.unpack_from(data, body)
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
        _scan_messages(scan, data, start, min(end, size), -1)
        if not whole:
            raise cut_off
        return
    if end > size:
        raise cut_off
    scan.compressed_chunks.append((compression, start, records_length))
    number = len(scan.compressed_chunks) - 1
    records = decompressed(scan, number)
    if checksum and zlib.crc32(records) != checksum:
        raise _DamageError(f"the chunk at byte {body - _RECORD_HEAD.size} is damaged")
    _scan_messages(scan, records, 0, len(records), number)


def _scan_messages(scan: McapScan, data: Buffer, start: int, end: int, chunk: int) -> None:
    """Scan the records of a chunk that lie wholly before ``end``."""
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
            scan.places.append(
                MessagePlace(
                    channel, log_time, body + _MESSAGE_FIELDS, length - _MESSAGE_FIELDS, chunk
                )
            )
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            _scan_small_record(scan, opcode, data[body : body + length], position)
        position = body + length
