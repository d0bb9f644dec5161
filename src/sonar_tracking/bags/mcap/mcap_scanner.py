"""Reading of the records of an MCAP file one after another, past what is damaged."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

from mcap.opcode import Opcode

from sonar_tracking.bags.contents import decompression
from sonar_tracking.bags.contents.decompression import TooLargeError
from sonar_tracking.bags.contents.storage_file import UnreadableFileError
from sonar_tracking.bags.mcap.mcap_checksums import (
    OPCODE,
    TAG,
    Buffer,
    RecordChecksum,
    read_checksums,
)
from sonar_tracking.bags.mcap.mcap_chunks import (
    UNCOMPRESSED_HEAD_BYTES,
    Chunk,
    DamageError,
    chunk_at,
    chunk_records,
    has_its_checksum,
)
from sonar_tracking.bags.mcap.mcap_damage import DamageReport
from sonar_tracking.bags.mcap.mcap_descriptions import Descriptions
from sonar_tracking.bags.mcap.mcap_resynchronisation import Resynchronisation
from sonar_tracking.bags.mcap.mcap_scan import (
    MESSAGE_FIELDS,
    McapScan,
    MessageRun,
    mapped_file,
)
from sonar_tracking.bags.mcap.mcap_summary import (
    RECORD_HEAD,
    read_summary,
)
from sonar_tracking.bags.mcap.mcap_writer import MAGIC, MESSAGE_HEAD

_LOOSE_MESSAGES = 1000
"""Most messages outside of chunks that are put in order at once."""
_SHIFT = 4096
"""How far from its place a record is looked for after bytes were inserted or lost."""
_PLACES_TRIED = 16
_MOST_PLACES = 50_000
"""No more damaged places are looked behind: a file may be made of nothing else."""


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
        If the file cannot be opened, is no MCAP file, or nothing in it can be read.
    TooLargeError
        If what is compressed in it exceeds its bound, and nothing else can be read.
    ConfigurationError
        If it is compressed and cannot be decompressed here.
    """
    scan = McapScan(name, mapped_file(path, name))
    scanner = _Scanner(scan)
    scanner.run()
    begins_right = scan.data[: len(MAGIC)] == MAGIC[: len(scan.data)]
    if not begins_right and not scan.channels:
        raise UnreadableFileError(
            f"{name} is not an MCAP file; give a rosbag2 directory or a file that ends in .mcap."
        )
    if scanner.lost_chunks and not scan.runs:
        if "would decompress" in scan.damage:
            raise TooLargeError(f"{name} cannot be read ({scan.damage}).")
        raise UnreadableFileError(f"{name} cannot be read ({scan.damage}).")
    return scan


class _Scanner:
    """Fills a scan from its data."""

    def __init__(self, scan: McapScan) -> None:
        self._scan = scan
        self._data = scan.data
        self._summary = read_summary(scan.data)
        self._limit = self._summary.data_end
        self._search = Resynchronisation(self._data, self._limit, self._summary)
        self._report = DamageReport(self._summary)
        self._room = decompression.largest_total(len(self._data))
        self._descriptions = Descriptions(scan, self._summary)
        self._pending: list[RecordChecksum] = []
        self._loose: MessageRun | None = None
        self._known_chunks = sorted(self._summary.chunks, reverse=True)
        self._chunked = bool(self._known_chunks)
        self.lost_chunks = 0

    def run(self) -> None:
        """Read the whole file."""
        position = len(MAGIC)
        if self._data[:position] != MAGIC[: len(self._data)]:
            self._report.note(0, position, "its first bytes are damaged")
            is_header = self._data[position : position + 1] == bytes([Opcode.HEADER])
            if not is_header or not self._search.is_record(position):
                position = self._next_record(0)
        while position < self._limit:
            position = self._after_record(position)
        if self._summary.verified:
            self._finish(self._limit)
        self._report.end(len(self._data))
        self._scan.damage = self._report.text()
        self._scan.losses = self._report.losses(self._scan.channels)

    def _after_record(self, position: int) -> int:
        """Take up the record at ``position``; return where to go on."""
        pending, self._pending = self._pending, []
        index = self._summary.chunks.get(position)
        opcode = self._data[position]
        try:
            if index is not None or opcode == Opcode.CHUNK or (pending and pending[0].channel):
                self._loose, self._chunked = None, True
                return self._take_chunk(position, pending)
            end = self._end_of_record(position)
            if opcode == Opcode.MESSAGE:
                self._take_loose(position, end)
                return end
            self._loose = None
            if pending and not pending[0].fits(self._data, position):
                raise DamageError(f"the record at byte {position} is damaged")
            return self._take_small(opcode, position, end, bool(pending))
        except DamageError as reason:
            return self._after_damage(position, str(reason), pending)

    def _end_of_record(self, position: int) -> int:
        size = len(self._data)
        if self._limit - position < RECORD_HEAD.size:
            raise DamageError(f"it ends at byte {size} without its closing part")
        _, length = RECORD_HEAD.unpack_from(self._data, position)
        end: int = position + RECORD_HEAD.size + length
        while self._known_chunks and self._known_chunks[-1] <= position:
            self._known_chunks.pop()
        if end > self._limit and not self._summary.verified:
            raise DamageError(f"it ends at byte {size} in the middle of a record")
        if end > self._limit or (self._known_chunks and end > self._known_chunks[-1]):
            raise DamageError(f"the record at byte {position} is damaged")
        return end

    def _after_damage(self, position: int, reason: str, pending: list[RecordChecksum]) -> int:
        """Note the damage at ``position``; return where to go on."""
        self._loose = None
        end = self._limit + 1
        if self._limit - position >= RECORD_HEAD.size:
            end = position + RECORD_HEAD.size + RECORD_HEAD.unpack_from(self._data, position)[1]
        if pending and not pending[0].channel:
            end = position + pending[0].length
        if self._report.places >= _MOST_PLACES:
            self._report.note(position, self._limit, "it is damaged in too many places to read on")
            return self._limit
        known = self._known_chunks[-1] if self._known_chunks else self._limit
        if end <= self._limit and not position < known < end and self._search.are_records(end, 2):
            following = end
        else:
            following = self._next_record(position + 1)
        self._report.note(position, following, reason)
        return following

    def _next_record(self, position: int) -> int:
        loose = not self._chunked and not self._report.numbered
        found = self._search.next_record(position, loose)
        return self._limit if found is None else min(found, self._limit)

    def _take_small(self, opcode: int, position: int, end: int, verified: bool) -> int:
        """Take up a record that is neither chunk nor message; return where to go on."""
        content = self._data[position + RECORD_HEAD.size : end]
        if opcode == OPCODE and (content.startswith(TAG) or self._report.numbered):
            entries = read_checksums(self._data, position)
            if entries is None:
                raise DamageError(f"the record at byte {position} is damaged")
            self._pending, self._report.numbered = entries, True
        elif opcode == 0 or Opcode.DATA_END < opcode < 0x80:
            raise DamageError(f"there is no MCAP record at byte {position}")
        elif opcode == Opcode.DATA_END and len(content) == 4:
            self._finish(position)
            return self._limit
        elif opcode == Opcode.FOOTER:
            return self._limit
        else:
            self._take_description(opcode, content, position, verified)
        return end

    def _take_description(self, opcode: int, content: bytes, position: int, verified: bool) -> None:
        try:
            self._descriptions.take(opcode, content, verified)
        except ValueError as error:
            raise DamageError(f"the record at byte {position} is damaged") from error

    def _take_chunk(self, position: int, pending: list[RecordChecksum]) -> int:
        """Take up the messages of the chunk at ``position``; return where to go on."""
        try:
            chunk = chunk_at(self._data, position, self._summary.chunks.get(position))
        except DamageError:
            if not pending:
                self.lost_chunks += 1
                raise
            start = position + UNCOMPRESSED_HEAD_BYTES
            length = sum(entry.length for entry in pending)
            self._report.note(position, start, f"the chunk at byte {position} is damaged")
            chunk = Chunk("", start, length, length, 0)
        if chunk.compression:
            self._take_compressed(chunk)
        elif has_its_checksum(self._data, chunk):
            self._take_messages(self._data, chunk.start, chunk.end, MessageRun(-1, 0, 0), True)
        elif pending:
            return self._take_checked(position, chunk, pending)
        elif chunk.end > self._limit:
            if self._search.next_record(position + 1, False) is not None:
                self.lost_chunks += 1
                raise DamageError(f"the chunk at byte {position} is damaged")
            self._take_messages(self._data, chunk.start, self._limit, MessageRun(-1, 0, 0), False)
            raise DamageError(f"it ends at byte {len(self._data)} in the middle of a chunk")
        elif chunk.checksum:
            self.lost_chunks += 1
            raise DamageError(f"the chunk at byte {position} is damaged")
        else:
            self._take_messages(self._data, chunk.start, chunk.end, MessageRun(-1, 0, 0), False)
        return chunk.end

    def _take_compressed(self, chunk: Chunk) -> None:
        self.lost_chunks += 1
        if chunk.end > self._limit:
            raise DamageError(f"it ends at byte {len(self._data)} in the middle of a chunk")
        self._room -= chunk.size
        if self._room < 0:
            raise DamageError(
                f"its chunks would decompress to far more than a recording holds ({chunk.size} "
                f"bytes from {chunk.length} at byte {chunk.start})"
            )
        records = chunk_records(self._data, chunk, self._scan.name)
        self.lost_chunks -= 1
        self._scan.compressed_chunks.append(chunk)
        run = MessageRun(len(self._scan.compressed_chunks) - 1, 0, 0)
        self._take_messages(records, 0, len(records), run, bool(chunk.checksum))

    def _take_messages(
        self, data: Buffer, start: int, end: int, run: MessageRun, verified: bool
    ) -> None:
        """Take up the records that lie wholly between two places; only the first may be left."""
        position = run.start = start
        while end - position >= RECORD_HEAD.size:
            opcode, length = RECORD_HEAD.unpack_from(data, position)
            following = position + RECORD_HEAD.size + length
            if following > end:
                return
            if opcode == Opcode.MESSAGE and length >= MESSAGE_FIELDS:
                self._take_message(data, position, following, run, verified)
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                content = bytes(data[position + RECORD_HEAD.size : following])
                self._take_description(opcode, content, position, verified)
            position = following

    def _take_message(
        self, data: Buffer, position: int, end: int, run: MessageRun, verified: bool
    ) -> None:
        _, _, channel, sequence, log_time, _ = MESSAGE_HEAD.unpack_from(data, position)
        if channel not in self._scan.channels:
            self._report.orphan(position)
            return
        if not run.counts:
            self._scan.runs.append(run)
        run.add(channel, log_time, end)
        self._report.take(channel, sequence, log_time, verified)

    def _take_loose(self, position: int, end: int) -> None:
        """Take up a message outside of chunks."""
        if self._chunked or self._report.numbered:
            raise DamageError(f"the record at byte {position} is damaged")
        if end - position < MESSAGE_HEAD.size or not self._search.is_record(end):
            raise DamageError(f"the message at byte {position} is damaged")
        if self._loose is None or sum(self._loose.counts.values()) >= _LOOSE_MESSAGES:
            self._loose = MessageRun(-1, position, position)
        self._take_message(self._data, position, end, self._loose, False)

    def _take_checked(self, position: int, chunk: Chunk, entries: Sequence[RecordChecksum]) -> int:
        """Take up the messages of a damaged chunk one by one; return where to go on."""
        hit = f"the chunk at byte {position} is damaged"
        cut_off = f"it ends at byte {len(self._data)} in the middle of a chunk"
        run: MessageRun | None = None
        whole_until = expected = chunk.start
        for entry in entries:
            start = self._place_of(entry, whole_until, expected)
            expected = (expected if start is None else start) + entry.length
            if start is None:
                left = max(min(entry.length, self._limit - (expected - entry.length)), 0)
                self._report.lose(entry.channel, left, cut_off if expected > self._limit else hit)
                run = None
                continue
            if run is None or run.end != start:
                run = MessageRun(-1, start, start)
            self._take_message(self._data, start, expected, run, True)
            whole_until = expected
        if expected > self._limit:
            return self._next_record(whole_until)
        if self._search.are_records(expected, 2):
            return expected
        return self._next_record(whole_until)

    def _place_of(self, entry: RecordChecksum, first: int, expected: int) -> int | None:
        """Return where a message record begins: where it should, or else nearby."""
        if entry.fits(self._data, expected):
            return expected
        head = RECORD_HEAD.pack(Opcode.MESSAGE, entry.length - RECORD_HEAD.size)
        head += struct.pack("<H", entry.channel)
        first = max(first, expected - _SHIFT)
        last = expected + _SHIFT + len(head)
        for _ in range(_PLACES_TRIED):
            found = self._data.find(head, first, last)
            if found < 0 or entry.fits(self._data, found):
                return None if found < 0 else found
            first = found + 1
        return None

    def _finish(self, position: int) -> None:
        """Compare the whole file with its checksum; ``position`` is where its data end."""
        self._report.finished = True
        (checksum,) = struct.unpack_from("<I", self._data, position + RECORD_HEAD.size)
        if checksum and not self._report.damaged:
            actual = zlib.crc32(memoryview(self._data)[:position])
            if actual != checksum:
                self._report.unlike_checksum()
