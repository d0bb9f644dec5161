"""What goes over the socket of the live page: text frames, and binary frames for rows of pictures.

A text frame is a JSON object with ``kind`` and ``t``, its data time in seconds; what is unknown is
null. Where several wait, they go as one list. A binary frame is the length of its JSON header
(uint32, little-endian), the header, padded by spaces so that the payload is aligned, and one row of
float32, little-endian.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import NANOSECONDS

VERSION = 1
"""Of the protocol; a page of another version loads itself anew."""

_ALIGNMENT = 4


class Frame(NamedTuple):
    """One message to the page.

    Attributes
    ----------
    kind : str
        What it carries.
    stream : str
        Frames of one stream replace one another as the newest picture, e.g. a topic.
    time : float
        Data time, s; NaN = none.
    data : str or bytes
        As it is sent.
    """

    kind: str
    stream: str
    time: float
    data: str | bytes


def text_frame(kind: str, time: float, stream: str = "", /, **fields: Any) -> Frame:
    """Return a text frame.

    Parameters
    ----------
    kind : str
        What it carries.
    time : float
        Data time, s.
    stream : str
        Which of several of its kind, e.g. the topic.
    **fields
        Numbers, texts, arrays, and lists and mappings of them.
    """
    return Frame(kind, f"{kind} {stream}", time, _json(kind, time, fields))


def binary_frame(
    kind: str, time: float, stream: str, header: Mapping[str, Any], row: NDArray[Any]
) -> Frame:
    """Return a binary frame.

    Parameters
    ----------
    kind : str
        What it carries.
    time : float
        Data time, s.
    stream : str
        Which of several of its kind, e.g. sensor and time scale.
    header : mapping
        Fields besides ``kind`` and ``t``.
    row : ndarray, shape (n,)
        Levels, dB.
    """
    text = _json(kind, time, header).encode()
    text += b" " * (-len(text) % _ALIGNMENT)
    payload = np.ascontiguousarray(row, "<f4").tobytes()
    data = struct.pack("<I", len(text)) + text + payload
    return Frame(kind, f"{kind} {stream}", time, data)


def _json(kind: str, time: float, fields: Mapping[str, Any]) -> str:
    content = {"kind": kind, "t": time, **fields}
    return json.dumps(plain(content), separators=(",", ":"), allow_nan=False)


def seconds_of(stamp: int) -> float:
    """Return the data time of a stamp in ns, s."""
    return stamp / NANOSECONDS


def plain(value: Any) -> Any:
    """Return a value as JSON knows it: arrays become lists; NaN and infinity null."""
    if isinstance(value, np.ndarray):
        return _plain_array(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, Mapping):
        return {str(name): plain(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return value


def _plain_array(values: NDArray[Any]) -> Any:
    if values.dtype.kind != "f":
        return values.tolist()
    if np.isfinite(values).all():
        return values.tolist()
    known = values.astype(object)
    known[~np.isfinite(values)] = None
    return known.tolist()


def rounded(values: FloatArray, digits: int = 5) -> FloatArray:
    """Return values to some significant digits, shape and unit unchanged: shorter as text."""
    with np.errstate(all="ignore"):
        size = np.floor(np.log10(np.abs(values)))
        unit = np.where(np.isfinite(size), 10.0 ** (digits - 1 - size), 1.0)
        unit = np.where(np.isfinite(unit) & (unit > 0.0), unit, 1.0)
        return np.round(values * unit) / unit


def upper_triangle(covariance: FloatArray) -> FloatArray:
    """Return ``xx, xy, yy`` of covariances, shape (3 n,), from shape (n, 2, 2); unit unchanged."""
    rows, columns = np.triu_indices(2)
    return covariance[:, rows, columns].reshape(-1)
