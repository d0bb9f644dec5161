"""Messages as bytes, field by field (little-endian CDR, version 1).

What a simulator publishes ten times a second and more is not made a message of first: neither are
its objects built, nor are they converted twice, which takes three times as long.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.time import NANOSECONDS

HEAD = b"\0\1\0\0"
_TIME = struct.Struct("<iI").pack
_COUNT = struct.Struct("<I").pack
_GAPS = tuple(bytes(length) for length in range(8))


class CdrWriter:
    """One message in the making; its fields are added in the order of the definition."""

    def __init__(self) -> None:
        self._data = bytearray(HEAD)

    def time(self, stamp: int) -> None:
        """Add a time, ns."""
        self._align(4)
        self._data += _TIME(*divmod(stamp, NANOSECONDS))

    def count(self, number: int) -> None:
        """Add a uint32."""
        self._align(4)
        self._data += _COUNT(number)

    def byte(self, number: int) -> None:
        """Add a uint8."""
        self._data.append(number)

    def text(self, text: str) -> None:
        """Add a string."""
        encoded = text.encode() + b"\0"
        self.count(len(encoded))
        self._data += encoded

    def reals(self, *numbers: float) -> None:
        """Add float64 numbers, one after the other."""
        self._align(8)
        self._data += struct.pack(f"<{len(numbers)}d", *numbers)

    def column(self, values: Any, dtype: str = "float64") -> None:
        """Add a sequence of numbers, row-major."""
        column = np.asarray(values, dtype)
        self.count(column.size)
        if column.size:
            self._align(column.itemsize)
            self._data += column.tobytes()

    def complex_column(self, values: Any, dtype: str = "float64") -> None:
        """Add complex numbers as a sequence of interleaved (re, im) of the given type."""
        complex_type = np.complex64 if dtype == "float32" else np.complex128
        self.column(np.ascontiguousarray(values, complex_type).reshape(-1).view(dtype), dtype)

    def octets(self, octets: bytes) -> None:
        """Add a sequence of uint8."""
        self.count(len(octets))
        self._data += octets

    def no_column(self) -> None:
        """Add an empty sequence."""
        self.count(0)

    def sensor(self, sensor: Sensor) -> None:
        """Add sensor_id, sensor_pose and sensor_velocity."""
        self.text(sensor.sensor_id)
        self.reals(*sensor.position, *sensor.orientation, *sensor.velocity)

    def message(self) -> bytes:
        """Return what was added so far, as a message."""
        return bytes(self._data)

    def _align(self, size: int) -> None:
        self._data += _GAPS[(len(HEAD) - len(self._data)) % size]
