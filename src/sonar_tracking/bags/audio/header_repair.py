"""Sizes in the head of W64, AIFF and CAF files that are put right for the library that reads them.

The file stays as it is: :class:`RepairedFile` shows it with other bytes in a few places.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

_MOST_CHUNKS = 1000


class RepairedFile:
    """A file, open for reading, in which some bytes are others.

    Parameters
    ----------
    path : Path
        The file.
    patches : mapping of int to bytes
        Position, and what is there instead.
    """

    def __init__(self, path: Path, patches: Mapping[int, bytes]) -> None:
        self._file = path.open("rb")
        self._patches = dict(patches)
        self._end = self._file.seek(0, os.SEEK_END)
        self._file.seek(0)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a position; one outside the file, by a damaged size, is its begin or end."""
        if whence == os.SEEK_CUR:
            offset += self._file.tell()
        elif whence == os.SEEK_END:
            offset += self._end
        return self._file.seek(min(max(offset, 0), self._end))

    def tell(self) -> int:
        """Return the position."""
        return self._file.tell()

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes."""
        begin = self._file.tell()
        data = self._file.read(size)
        for position, patch in self._patches.items():
            if begin < position + len(patch) and position < begin + len(data):
                changed = bytearray(data)
                for index, byte in enumerate(patch, position - begin):
                    if 0 <= index < len(data):
                        changed[index] = byte
                data = bytes(changed)
        return data

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __del__(self) -> None:
        # The library that reads it never closes what it was given.
        self._file.close()

    def __enter__(self) -> RepairedFile:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


@dataclass(frozen=True)
class _Container:
    """How chunks lie in a file: ``first`` is the position of the first one."""

    first: int
    header: str
    name_size: int
    align: int
    size_includes_header: bool
    data: bytes
    lead: int
    """Bytes of the data chunk before its samples."""


_CONTAINERS = {
    b"riff": _Container(40, "<q", 16, 8, True, b"data", 0),
    b"FORM": _Container(12, ">I", 4, 2, False, b"SSND", 8),
    b"caff": _Container(8, ">q", 4, 1, False, b"data", 4),
}


@dataclass(frozen=True)
class SampleChunk:
    """Where a file has its samples.

    Attributes
    ----------
    size_position : int
        Of the size of the chunk in the file.
    begin : int
        Of the samples.
    announced, held : int
        Bytes of samples by the head of the chunk, at least 0, and up to the next or the end.
    """

    size_position: int
    begin: int
    announced: int
    held: int
    _size_format: str
    _beside: int
    _frame_count_position: int

    def patches(self, frame: int) -> dict[int, bytes]:
        """Return what makes the head of the file agree with it; ``frame`` = bytes of a sample."""
        patches = {self.size_position: struct.pack(self._size_format, self.held + self._beside)}
        if self._frame_count_position:
            count = struct.pack(">I", self.held // frame)
            patches[self._frame_count_position] = count
        return patches


def sample_chunk(path: Path) -> SampleChunk | None:
    """Find the samples of a W64, AIFF or CAF file; None in others, and where there are none."""
    end = path.stat().st_size
    with path.open("rb") as file:
        container = _CONTAINERS.get(file.read(4))
        if container is None:
            return None
        header_size = container.name_size + struct.calcsize(container.header)
        position, frame_count = container.first, 0
        for _ in range(_MOST_CHUNKS):
            file.seek(position)
            header = file.read(header_size)
            if len(header) < header_size:
                return None
            (size,) = struct.unpack(container.header, header[container.name_size :])
            if header[:4] == container.data:
                break
            if header[:4] == b"COMM":
                frame_count = position + header_size + 2
            step = size if container.size_includes_header else size + header_size
            position += max(-(-step // container.align) * container.align, header_size)
        else:
            return None
        begin = position + header_size + container.lead
        beside = container.lead + (header_size if container.size_includes_header else 0)
        announced = max(size - beside, 0)
        held = end - begin
        if announced < held:
            following = -(-(begin + announced) // container.align) * container.align
            file.seek(following)
            name = file.read(4)
            if announced and (following >= end or name.isalnum() or name in (b"(c) ", b"AUTH")):
                held = announced
    return SampleChunk(
        position + container.name_size,
        begin,
        announced,
        max(held, 0),
        container.header,
        beside,
        frame_count,
    )
