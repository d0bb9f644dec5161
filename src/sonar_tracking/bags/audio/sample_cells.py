"""Bytes of samples become numbers: integers of 1 to 4 bytes, floating-point of 4 and 8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class SampleCells:
    """How a sample lies in its bytes, little-endian.

    Attributes
    ----------
    size : int
        Bytes.
    is_float : bool
        Floating-point, else integer: without sign in one byte, with sign in more.
    bits : int
        Of an integer below full scale, counted from its lowest bit.
    """

    size: int
    is_float: bool
    bits: int

    def decoded(self, data: bytes) -> FloatArray:
        """Return the samples, shape (n,), linear, full scale 1."""
        if self.is_float:
            return np.frombuffer(data, f"<f{self.size}").astype(np.float64)
        if self.size == 1:
            return (np.frombuffer(data, np.uint8).astype(np.float64) - 128.0) / 128.0
        if self.size == 3:
            # Three bytes become the upper ones of four, which keeps the sign.
            wide = np.zeros((len(data) // 3, 4), np.uint8)
            wide[:, 1:] = np.frombuffer(data, np.uint8).reshape(-1, 3)
            return wide.view("<i4").reshape(-1) / 2.0**31
        return np.frombuffer(data, f"<i{self.size}") / 2.0 ** (self.bits - 1)


def bits_in_cells(data: bytes, bits: int) -> int:
    """Return the bits below full scale of samples narrower than their cell of 4 bytes.

    Samples belong into the upper bytes; some recorders put them into the lower ones. Those that
    are all within the range of the lower ones, and have something in the lowest byte, are there.

    Parameters
    ----------
    data : bytes
        Some of the samples.
    bits : int
        That the file says a sample has.
    """
    values = np.frombuffer(data[: len(data) // 4 * 4], "<i4")
    spare = (1 << (32 - bits)) - 1
    in_upper = not (values & spare).any()
    limit = 1 << (bits - 1)
    in_lower = bool(((values >= -limit) & (values < limit)).all())
    return bits if in_lower and not in_upper else 32
