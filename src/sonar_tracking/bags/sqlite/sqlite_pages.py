"""Rows of a damaged sqlite3 file, taken from its pages without its indexes and its tree.

A table keeps its rows in leaf pages, each of which says where its rows stand and is of use without
the rest; what does not fit follows in a chain of overflow pages. Every page is asked for rows of
the wanted shape.

References
----------
Database file format, https://www.sqlite.org/fileformat2.html, sections 1.3, 1.6 and 2.1.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from typing import NamedTuple

_HEADER_BYTES = 100
_LEAF = 0x0D
_LEAF_HEAD_BYTES = 8
_SMALLEST_PAGE, _LARGEST_PAGE = 512, 65536
_INTEGER_BYTES = {0: 0, 1: 1, 2: 2, 3: 3, 4: 4, 5: 6, 6: 8, 8: 0, 9: 0}
_FIRST_BLOB, _FIRST_TEXT = 12, 13
_COLUMNS = 16
"""Most columns of a table of a bag."""

Value = int | bytes | str | None


class Row(NamedTuple):
    """A row.

    Attributes
    ----------
    place : int
        Where it begins in the file, bytes.
    number : int
        Its number in its table.
    columns : tuple of tuple
        Serial type and size of each column.
    payload : bytes
        What it holds, the columns at the end.
    """

    place: int
    number: int
    columns: tuple[tuple[int, int], ...]
    payload: bytes

    def values(self) -> tuple[Value, ...]:
        """Return the columns as values."""
        values, start = [], len(self.payload) - sum(length for _, length in self.columns)
        for kind, length in self.columns:
            values.append(_value(kind, self.payload[start : start + length]))
            start += length
        return tuple(values)


class SqlitePages:
    """The pages of a file.

    Parameters
    ----------
    data : bytes or mmap
        The file.
    page_bytes : int
        Size of a page; 0 = as its head says.
    """

    def __init__(self, data: bytes | mmap.mmap, page_bytes: int = 0) -> None:
        self._data = data
        (stated,) = struct.unpack_from(">H", data, 16) if len(data) >= _HEADER_BYTES else (0,)
        size = page_bytes or (_LARGEST_PAGE if stated == 1 else stated)
        if size & (size - 1) or not _SMALLEST_PAGE <= size <= _LARGEST_PAGE:
            size = 4096
        self._page_bytes = size
        reserved = data[20] if len(data) >= _HEADER_BYTES and data[20] < 64 else 0
        self._usable = size - reserved
        self.count = len(data) // size

    def rows(self) -> Iterator[Row]:
        """Yield the rows of all tables that can be read, in the order of the pages."""
        for page in range(1, self.count + 1):
            start = (page - 1) * self._page_bytes
            head = start + (_HEADER_BYTES if page == 1 else 0)
            if self._data[head] == _LEAF:
                yield from self._rows_of(start, head)

    def _rows_of(self, start: int, head: int) -> Iterator[Row]:
        (count,) = struct.unpack_from(">H", self._data, head + 3)
        count = min(count, (self._page_bytes - (head - start) - _LEAF_HEAD_BYTES) // 2)
        for place in range(count):
            (offset,) = struct.unpack_from(">H", self._data, head + _LEAF_HEAD_BYTES + 2 * place)
            if _LEAF_HEAD_BYTES <= offset < self._usable:
                row = self.row(start + offset)
                if row is not None:
                    yield row

    def row(self, place: int) -> Row | None:
        """Return the row that begins at a place in the file, if there is one."""
        end = place - place % self._page_bytes + self._usable
        position = place
        length, position = _varint(self._data, position, end)
        number, position = _varint(self._data, position, end)
        if not 2 <= length <= self._usable * self.count:
            return None
        local = self._local_bytes(length)
        if position + local + (4 if local < length else 0) > end:
            return None
        beginning = self._data[position : position + min(local, 64)]
        columns = _columns(beginning, length)
        if columns is None:
            return None
        payload = self._data[position : position + local]
        if local < length:
            (page,) = struct.unpack_from(">I", self._data, position + local)
            rest = self._overflow(page, length - local)
            if rest is None:
                return None
            payload += rest
        return Row(place, number, columns, payload)

    def _local_bytes(self, length: int) -> int:
        """Return how much of a row stands in the leaf page itself."""
        largest = self._usable - 35
        if length <= largest:
            return length
        smallest = (self._usable - 12) * 32 // 255 - 23
        wanted = smallest + (length - smallest) % (self._usable - 4)
        return wanted if wanted <= largest else smallest

    def _overflow(self, page: int, length: int) -> bytes | None:
        """Return what stands in a chain of overflow pages; None where the chain is broken."""
        parts = []
        for _ in range(self.count):
            if not 2 <= page <= self.count:
                return None
            start = (page - 1) * self._page_bytes
            (page,) = struct.unpack_from(">I", self._data, start)
            part = self._data[start + 4 : start + 4 + min(length, self._usable - 4)]
            parts.append(part)
            length -= len(part)
            if length <= 0:
                return b"".join(parts) if page == 0 else None
        return None


def _columns(payload: bytes, length: int) -> tuple[tuple[int, int], ...] | None:
    """Return serial types and sizes of the columns of a row, if they make up its length."""
    head, position = _varint(payload, 0, len(payload))
    if not 1 < head <= len(payload):
        return None
    columns: list[tuple[int, int]] = []
    while position < head and len(columns) < _COLUMNS:
        kind, position = _varint(payload, position, head)
        if kind >= _FIRST_BLOB:
            columns.append((kind, (kind - _FIRST_BLOB) // 2))
        elif kind in _INTEGER_BYTES:
            columns.append((kind, _INTEGER_BYTES[kind]))
        else:
            return None
    if position != head or head + sum(size for _, size in columns) != length:
        return None
    return tuple(columns)


def _value(kind: int, data: bytes) -> Value:
    if kind == 0:
        return None
    if kind in (8, 9):
        return kind - 8
    if kind < _FIRST_BLOB:
        return int.from_bytes(data, "big", signed=True)
    return data.decode("utf-8", "replace") if kind % 2 else data


def _varint(data: bytes | mmap.mmap, position: int, end: int) -> tuple[int, int]:
    """Return a number of up to nine bytes and where it ends; -1 where the data end before."""
    value = 0
    for place in range(9):
        if position >= end:
            return -1, position
        byte = data[position]
        position += 1
        if place == 8:
            return (value << 8) | byte, position
        value = (value << 7) | (byte & 0x7F)
        if byte < 0x80:
            return value, position
    return value, position
