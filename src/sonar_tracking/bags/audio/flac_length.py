"""How many samples a FLAC file holds, from its last frame (RFC 9639).

The number in the head of the file is zero or too small if the recorder did not come to its end.
"""

from __future__ import annotations

import re
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import BinaryIO

_STREAM = re.compile(rb"fLaC[\x00\x80]\x00\x00\x22", re.DOTALL)
"""Marker of a stream, with the head of its first block: always one of 34 bytes."""

_SYNC = re.compile(rb"\xff[\xf8\xf9]")
_SEARCHED = 1 << 20
"""Bytes at the end in which the last frame is looked for; frames are shorter."""

_SIZES = {1: 192, **{2 + n: 576 << n for n in range(4)}, **{8 + n: 256 << n for n in range(8)}}
_CRC_POLYNOMIAL = 0x07
_TOTAL_POSITION = 21
"""Of the byte whose lower half begins the number of samples, after marker and block header."""


def announced_samples(path: Path) -> int:
    """Return the number of samples in the head of a FLAC file; 0 = not known to it."""
    with path.open("rb") as file:
        head = file.read(_TOTAL_POSITION + 5)
    return int.from_bytes(head[_TOTAL_POSITION:], "big") & ((1 << 36) - 1)


def total_patch(path: Path, n_samples: int) -> dict[int, bytes]:
    """Return position and bytes that make the head of a FLAC file announce other samples."""
    with path.open("rb") as file:
        head = file.read(_TOTAL_POSITION + 5)
    upper = int.from_bytes(head[_TOTAL_POSITION:], "big") >> 36 << 36
    return {_TOTAL_POSITION: (upper | n_samples).to_bytes(5, "big")}


def further_stream(path: Path) -> tuple[int, int] | None:
    """Return where another stream begins behind the first, bytes, and its sample rate, Hz.

    None = there is none. Decoders end with the first stream, whatever its neighbour holds.
    """
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as data:
        found = _STREAM.search(data, 4)
        if found is None:
            return None
        rate = int.from_bytes(data[found.start() + 18 : found.start() + 21], "big") >> 4
        return found.start(), rate


def held_samples(path: Path) -> int | None:
    """Return the number of samples up to the end of the last frame; None if none is found."""
    end = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(26)
        smallest, largest = (int.from_bytes(head[at : at + 2], "big") for at in (8, 10))
        first = _first_frame(file)
        file.seek(max(end - _SEARCHED, 0))
        tail = file.read()
    block = largest if smallest == largest else None
    for match in reversed(list(_SYNC.finditer(tail))):
        header = tail[match.start() : match.start() + 20]
        # Samples may look like a header, but hardly like one of this file.
        if len(header) < 6 or _unchanging(header) != _unchanging(first):
            continue
        found = _frame_end(header, block)
        if found is not None:
            return found
    return None


def _first_frame(file: BinaryIO) -> bytes:
    """Return the begin of what follows the blocks of metadata."""
    position, is_last = 4, False
    while not is_last:
        file.seek(position)
        header = file.read(4)
        if len(header) < 4:
            break
        is_last = bool(header[0] & 0x80)
        position += 4 + int.from_bytes(header[1:], "big")
    file.seek(position)
    return file.read(4).ljust(4, b"\0")


def _unchanging(header: bytes) -> tuple[int, int, int]:
    """Return blocking strategy, rate and sample size: the same in all frames of a file."""
    return header[1], header[2] & 15, header[3] & 14


def _frame_end(data: bytes, block: int | None) -> int | None:
    """Return the sample a frame ends at, if its header is one."""
    if len(data) < 6 or data[3] & 1:
        return None
    number, position = _coded_number(data)
    size_code, rate_code = data[2] >> 4, data[2] & 15
    if number is None or size_code == 0 or rate_code == 15:
        return None
    size = _SIZES.get(size_code, 0)
    if size_code in (6, 7):
        width = size_code - 5
        size = int.from_bytes(data[position : position + width], "big") + 1
        position += width
    position += {12: 1, 13: 2, 14: 2}.get(rate_code, 0)
    if position >= len(data) or _crc(data[:position]) != data[position]:
        return None
    if data[1] & 1:
        return number + size
    return number * (block or size) + size


def _coded_number(data: bytes) -> tuple[int | None, int]:
    """Return the number of the frame or its first sample, coded as in UTF-8, and where it ends."""
    first = data[4]
    if first < 0x80:
        return first, 5
    extra = 0
    while extra < 7 and first & (0x40 >> extra):
        extra += 1
    following = data[5 : 5 + extra]
    if not 1 <= extra <= 6 or len(following) < extra or any(b >> 6 != 2 for b in following):
        return None, 0
    value = first & (0x3F >> extra)
    for byte in following:
        value = value << 6 | byte & 0x3F
    return value, 5 + extra


def _crc(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ _CRC_POLYNOMIAL if crc & 0x80 else crc << 1) & 0xFF
    return crc
