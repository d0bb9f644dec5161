"""Chunks of a RIFF, RF64 or BW64 file, as far as the file on the disk bears them out.

The size of a chunk is believed if another chunk, or the end of the file, is where it says.
Recorders that crash leave zero or an old size behind, those that pass 4 GB a wrapped one, and some
forget the byte that pads an odd size.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

_HEADER = 8
_SIZE_ELSEWHERE = 0xFFFFFFFF
_WRAP = 1 << 32
_MOST_CHUNKS = 1000
_SEARCHED = 1 << 20
"""Bytes in which the data are looked for where a chunk before them is damaged."""

_KNOWN = frozenset(
    (
        *("LIST", "INFO", "bext", "iXML", "axml", "aXML", "cue", "fact", "id3", "ID3", "JUNK"),
        *("junk", "PAD", "pad", "FLLR", "smpl", "inst", "PEAK", "data", "fmt", "DISP", "cart"),
        *("wamd", "guan", "harp", "umid", "levl", "link", "minf", "elm1", "regn", "acid", "chna"),
        *("_PMX", "afsp", "note", "plst", "ds64"),
    )
)
_NAME = re.compile(rb"[A-Za-z0-9_][A-Za-z0-9_ ]{2}[A-Za-z0-9_ \0]")


@dataclass
class RiffChunks:
    """What was found in a file.

    Attributes
    ----------
    bodies : dict of str to tuple of int
        Position and size, bytes, of the first chunk of each name but ``data``.
    data : list of tuple of int
        Position and size, bytes, of what the chunks with samples hold, in order.
    announced : int or None
        Bytes of samples the file says it holds; None if it does not say.
    zeros : int
        Bytes of nothing but zeros behind the last chunk.
    remarks : list of str
        Ends of sentences that begin with the name of the file.
    """

    bodies: dict[str, tuple[int, int]] = field(default_factory=dict)
    data: list[tuple[int, int]] = field(default_factory=list)
    announced: int | None = 0
    zeros: int = 0
    remarks: list[str] = field(default_factory=list)


def riff_chunks(path: Path) -> RiffChunks:
    """Find the chunks of a RIFF, RF64 or BW64 file."""
    with path.open("rb") as file:
        return _Walk(file, path.stat().st_size).chunks()


class _Walk:
    def __init__(self, file: BinaryIO, end: int) -> None:
        self._file, self._end = file, end
        self._found = RiffChunks()
        self._long_size: int | None = None

    def chunks(self) -> RiffChunks:
        position = 12
        for _ in range(_MOST_CHUNKS):
            if position + _HEADER > self._end:
                break
            name, size = self._header(position)
            if not self._is_name(name):
                position = self._lost(position)
                continue
            body = position + _HEADER
            if name == b"data":
                position = self._take_data(body, size)
                continue
            if name == b"ds64":
                self._long_size = struct.unpack("<Q", self._read(body + 8, 8).ljust(8, b"\0"))[0]
            self._found.bodies.setdefault(name.decode("latin-1"), (body, size))
            position = self._next(body, size)
        return self._found

    def _take_data(self, body: int, size: int) -> int:
        """Take samples from ``body`` on and return where to go on."""
        if size == _SIZE_ELSEWHERE:
            size = self._long_size or 0
        following = self._data_end(body, size)
        held = (following if following is not None else self._end) - body
        if following is not None and held < size:
            held = size  # an odd size without its padding
        if following is None and size and self._only_zeros(body + size):
            self._found.zeros = self._end - body - size
            held = size
        self._found.data.append((body, min(held, self._end - body)))
        if size and self._found.announced is not None:
            self._found.announced += size
        elif held and not size:
            self._found.announced = None
        return self._end if following is None else following

    def _data_end(self, body: int, size: int) -> int | None:
        """Return where the chunk after the samples begins, or None if no size leads there."""
        if body + size >= self._end:
            return self._end
        for true_size in range(size, self._end - body + 1, _WRAP):
            for position in (body + true_size + true_size % 2, body + true_size):
                if self._fits(position):
                    return position
        return None

    def _fits(self, position: int) -> bool:
        """Return whether chunks follow one another from here to the end."""
        if self._end - 1 <= position <= self._end + 1:
            return True
        for _ in range(_MOST_CHUNKS):
            if position + _HEADER > self._end:
                return position <= self._end + 1
            name, size = self._header(position)
            if self._is_known(name):
                return True
            if not self._is_name(name):
                return False
            position += _HEADER + size + size % 2
        return False

    def _next(self, body: int, size: int) -> int:
        """Return where the chunk after one without samples begins."""
        end = body + size
        if size % 2 and end + _HEADER <= self._end:
            padded, bare = (self._header(at)[0] for at in (end + 1, end))
            # Behind a missing byte, a size of many samples makes b"ata\0" of b"data".
            likelier = self._is_known(bare) and not self._is_known(padded)
            if self._is_name(bare) and (likelier or not self._is_name(padded)):
                self._found.remarks.append("lacks the byte that pads a chunk of odd size")
                return end
        return end + size % 2 if end <= self._end else self._lost(body)

    def _lost(self, position: int) -> int:
        """Return where the samples begin behind a damaged chunk, or the end of the file."""
        if self._found.data:
            if self._only_zeros(position):
                self._found.zeros = self._end - position
            else:
                rest = self._end - position
                self._found.remarks.append(
                    f"has {rest} bytes behind its samples that are no chunk; they are left out"
                )
            return self._end
        at = self._read(position, _SEARCHED).find(b"data")
        if at < 0:
            return self._end
        self._found.remarks.append("has a damaged chunk before its samples")
        return position + at

    def _only_zeros(self, position: int) -> bool:
        self._file.seek(position)
        while piece := self._file.read(_SEARCHED):
            if piece.count(0) != len(piece):
                return False
        return True

    def _header(self, position: int) -> tuple[bytes, int]:
        name, size = struct.unpack("<4sI", self._read(position, _HEADER).ljust(_HEADER, b"\0"))
        return name, size

    def _read(self, position: int, count: int) -> bytes:
        self._file.seek(position)
        return self._file.read(count)

    @staticmethod
    def _is_known(name: bytes) -> bool:
        return name.rstrip(b" \0").decode("latin-1") in _KNOWN

    @staticmethod
    def _is_name(name: bytes) -> bool:
        return (
            re.fullmatch(rb"[A-Za-z0-9_ ]{3}[A-Za-z0-9_ \0]", name) is not None and name[:1] != b" "
        )
