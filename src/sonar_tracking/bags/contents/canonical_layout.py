"""The canonical form of a serialised message without decoding it: only its padding is touched.

Decoding a message and encoding it again gives its bytes with zero padding and nothing behind the
last field. The same follows from walking over the fields: where each ends, how far the next one is
aligned. It is an order of magnitude faster, for what it does to a column does not depend on the
length. Types with fields whose bytes may change on the way (a lone ``bool`` or ``float32``) have no
such layout.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from sonar_tracking.errors import InputError

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc
    from rosbags.typesys.store import Typestore

_HEAD = b"\0\1\0\0"
_LONGEST_TAIL = 3
_LENGTH = struct.Struct("<I").unpack_from
_SIZES = {
    **dict.fromkeys(("byte", "char", "int8", "uint8"), 1),
    **dict.fromkeys(("int16", "uint16"), 2),
    **dict.fromkeys(("int32", "uint32"), 4),
    **dict.fromkeys(("int64", "uint64", "float64"), 8),
}
_COLUMN_SIZES = {**_SIZES, "bool": 1, "float32": 4}


class _Numbers(NamedTuple):
    size: int
    length: int


class _Column(NamedTuple):
    size: int


class _Text(NamedTuple):
    pass


class _Repeated(NamedTuple):
    """As often as a number before it says."""

    fields: list[Any]


class _UnknownLayoutError(Exception):
    pass


class _Walk:
    """A walk over the fields of a message, and what it found.

    Messages of one topic are mostly of one build: as many entries in each column, the same texts.
    Where this is so the next walk would lead to the same places.
    """

    def __init__(self, data: bytes) -> None:
        self.end = 0
        self.gaps: list[tuple[int, int]] = []
        self._data = data
        self._build: list[tuple[int, int, bytes]] = []

    def fits(self, data: bytes) -> bool:
        """Tell whether a message has the same build: its lengths and texts, byte by byte."""
        if len(data) != len(self._data):
            return False
        return all(data[begin:end] == same for begin, end, same in self._build)

    def over(self, fields: list[Any], begin: int) -> int:
        """Note the padding between some fields; return where the last one ends."""
        data, position = self._data, begin
        for field in fields:
            if isinstance(field, _Numbers):
                position = self._aligned(position, field.size) + field.size * field.length
                continue
            position = self._aligned(position, 4)
            (length,) = _LENGTH(data, position)
            position += 4
            self._note(position - 4, position)
            if isinstance(field, _Column):
                if length:
                    position = self._aligned(position, field.size) + length * field.size
            elif isinstance(field, _Text):
                end = position + length
                if not length or end > len(data) or data[end - 1]:
                    raise ValueError(f"a text of {length} bytes at {position} does not end there")
                data[position : end - 1].decode()
                self._note(position, end)
                position = end
            else:
                if position + length > len(data):
                    raise ValueError(f"{length} entries at {position} are more than the bytes")
                for _ in range(length):
                    position = self.over(field.fields, position)
        return position

    def _note(self, begin: int, end: int) -> None:
        self._build.append((begin, end, self._data[begin:end]))

    def _aligned(self, position: int, size: int) -> int:
        """Return where a field of some size begins, the padding before it noted."""
        gap = (4 - position) % size
        if gap and position + gap <= len(self._data):
            self.gaps.append((position, position + gap))
        return position + gap


class CanonicalLayout:
    """Where the padding is in the messages of one type, little-endian.

    Parameters
    ----------
    store : Typestore
        Knows the type.
    type_name : str
        Full name of the message type.

    Attributes
    ----------
    is_known : bool
        False = messages of this type have to be decoded.
    """

    def __init__(self, store: Typestore, type_name: str) -> None:
        self._type_name = type_name
        self._fields: list[Any] = []
        self._walk: _Walk | None = None
        self.is_known = True
        try:
            self._fields = _merged(_fields_of(store, type_name))
        except _UnknownLayoutError:
            self.is_known = False

    def canonical(self, raw_cdr: bytes) -> memoryview:
        """Return a little-endian message with zero padding and without tail bytes.

        Raises
        ------
        InputError
            If the bytes are not a message of this type.
        """
        walk = self._walk
        if walk is None or not walk.fits(raw_cdr):
            walk = self._walk = self._walked(raw_cdr)
        data = bytearray(raw_cdr)
        data[:4] = _HEAD
        for begin, end in walk.gaps:
            data[begin:end] = bytes(end - begin)
        return memoryview(data)[: walk.end]

    def _walked(self, raw_cdr: bytes) -> _Walk:
        walk = _Walk(raw_cdr)
        try:
            walk.end = walk.over(self._fields, 4)
        except (struct.error, ValueError, IndexError) as error:
            raise self._error(raw_cdr, str(error)) from error
        if not walk.end <= len(raw_cdr) <= walk.end + _LONGEST_TAIL:
            raise self._error(raw_cdr, f"it would end after {walk.end}")
        return walk

    def _error(self, raw_cdr: bytes, reason: str) -> InputError:
        return InputError(
            f"{len(raw_cdr)} bytes are not a message of type {self._type_name} ({reason})."
        )


def _fields_of(store: Typestore, type_name: str) -> list[Any]:
    # Not the definition, which is compiled for decoding when it is asked for.
    fields = store.fielddefs[type_name][1]
    return [part for _, description in fields for part in _parts(store, description)]


def _parts(store: Typestore, description: FieldDesc) -> list[Any]:
    """Return what a field is made of."""
    from rosbags.interfaces import Nodetype

    kind, detail = description
    if kind == Nodetype.NAME:
        return _fields_of(store, str(detail))
    if kind == Nodetype.BASE:
        name = str(detail[0])
        return [_Text()] if name == "string" else [_Numbers(_size(_SIZES, name), 1)]
    element = cast("FieldDesc", detail[0])
    if kind == Nodetype.ARRAY:
        if element[0] == Nodetype.BASE and element[1][0] != "string":
            return [_Numbers(_size(_COLUMN_SIZES, str(element[1][0])), int(cast("int", detail[1])))]
        return _parts(store, element) * int(cast("int", detail[1]))
    if element[0] == Nodetype.BASE and element[1][0] != "string":
        return [_Column(_size(_COLUMN_SIZES, str(element[1][0])))]
    return [_Repeated(_merged(_parts(store, element)))]


def _size(sizes: dict[str, int], name: str) -> int:
    if name not in sizes:
        raise _UnknownLayoutError(name)
    return sizes[name]


def _merged(fields: list[Any]) -> list[Any]:
    """Return the fields, numbers of one size that follow each other as one."""
    merged: list[Any] = []
    for field in fields:
        last = merged[-1] if merged else None
        if isinstance(field, _Numbers) and isinstance(last, _Numbers) and last.size == field.size:
            merged[-1] = _Numbers(field.size, last.length + field.length)
        else:
            merged.append(field)
    return merged
