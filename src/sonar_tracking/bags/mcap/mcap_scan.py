"""What an MCAP file holds, whole or not.

A file is read record after record from its beginning. Where what stands there is not what was
written, the next record that can be told from chance is looked for: the closing part of the file
(if its own checksum fits) says where chunks begin; else they are found by their shape. What was
left out is counted by the numbers in the closing part, or by those of the messages.
"""

from __future__ import annotations

import io
import mmap
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.storage_file import UnreadableFileError
from sonar_tracking.bags.mcap.mcap_checksums import Buffer
from sonar_tracking.bags.mcap.mcap_chunks import Chunk, chunk_records
from sonar_tracking.bags.mcap.mcap_summary import RECORD_HEAD
from sonar_tracking.bags.mcap.mcap_writer import MESSAGE_HEAD

MESSAGE_FIELDS = MESSAGE_HEAD.size - RECORD_HEAD.size
"""Bytes of a message record before the message itself."""


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
    """Whole messages that follow one another: those of a chunk, or some outside of chunks.

    Attributes
    ----------
    chunk : int
        Index into ``compressed_chunks`` of the scan; -1 = in the file itself.
    start, end : int
        Their records, in the file or in the decompressed chunk, bytes.
    first, last : int
        Earliest and latest log time, ns.
    counts : dict
        Number of messages by channel number.
    """

    chunk: int
    start: int
    end: int
    first: int = 0
    last: int = 0
    counts: dict[int, int] = field(default_factory=dict)

    def add(self, channel: int, log_time: int, end: int) -> None:
        """Add the message record that ends at ``end``."""
        self.first = min(self.first, log_time) if self.counts else log_time
        self.last = max(self.last, log_time)
        self.counts[channel] = self.counts.get(channel, 0) + 1
        self.end = end


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
    compressed_chunks : list of Chunk
        Those whose records must be decompressed.
    damage : str
        Why not all of it can be read; empty where it can.
    losses : list of Loss
        Messages that cannot be read.
    """

    name: str
    data: Buffer
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    runs: list[MessageRun] = field(default_factory=list)
    compressed_chunks: list[Chunk] = field(default_factory=list)
    damage: str = ""
    losses: list[Loss] = field(default_factory=list)


def mapped_file(path: Path, name: str) -> Buffer:
    """Return the bytes of a file; they stay on the disk.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        What to call it in errors.

    Raises
    ------
    UnreadableFileError
        If the file cannot be opened or is empty.
    """
    try:
        with path.open("rb") as file:
            if file.seek(0, io.SEEK_END):
                return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except OSError as error:
        raise UnreadableFileError(f"{name} cannot be read ({error.strerror}).") from error
    raise UnreadableFileError(f"{name} is empty; nothing was recorded.")


def places_of(scan: McapScan, run: MessageRun) -> tuple[Buffer, list[MessagePlace]]:
    """Return the messages of a run in log order, and the data they lie in.

    Messages of equal log time are in the order of recording.
    """
    data = scan.data
    if run.chunk >= 0:
        data = chunk_records(scan.data, scan.compressed_chunks[run.chunk], scan.name)
    places, position = [], run.start
    while position < run.end:
        opcode, length = RECORD_HEAD.unpack_from(data, position)
        if opcode == Opcode.MESSAGE and length >= MESSAGE_FIELDS:
            _, _, channel, _, log_time, _ = MESSAGE_HEAD.unpack_from(data, position)
            start = position + MESSAGE_HEAD.size
            places.append(MessagePlace(log_time, channel, start, length - MESSAGE_FIELDS))
        position += RECORD_HEAD.size + length
    places.sort(key=lambda place: place.log_time)
    return data, places
