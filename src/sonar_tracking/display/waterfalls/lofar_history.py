"""Past LOFAR rows of every beam, in little memory, for whoever selects a beam late."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.display.waterfalls.lofar_rows import LofarRow

LARGEST = 64 * 1024 * 1024
"""Bytes kept of all beams together, the newest."""


_NOTHING: NDArray[np.float32] = np.empty(0, np.float32)


class LofarHistory:
    """Keeps the rows of all beams.

    Levels are kept in half precision, which is good to 0.03 dB.

    Parameters
    ----------
    seconds : float
        Data time kept.
    """

    def __init__(self, seconds: float) -> None:
        self._kept = round(seconds * 1e9)
        self._rows: deque[tuple[LofarRow, NDArray[np.float16]]] = deque()
        self._bytes = 0

    def add(self, row: LofarRow) -> None:
        """Keep a row, and forget what is too old or too much."""
        levels = row.level_db.astype(np.float16)
        self._rows.append((replace(row, level_db=_NOTHING), levels))
        self._bytes += levels.nbytes
        while self._bytes > LARGEST or self._rows[0][0].end < row.end - self._kept:
            self._bytes -= self._rows.popleft()[1].nbytes

    def of(self, sensor_id: str, track_id: int) -> Iterator[LofarRow]:
        """Yield the rows of the beam of a bearing track, in order of time."""
        for row, levels in tuple(self._rows):
            if row.sensor_id == sensor_id and row.track_id == track_id:
                yield replace(row, level_db=levels.astype(np.float32))
