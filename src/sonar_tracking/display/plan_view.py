"""Plan view for the terminal: where the tracks are, seen from above, north up.

Each established track is the last character of its identifier, its past a trail of dots; ``#`` is
something fixed, ``+`` the origin of ``map``. A row of the terminal is about twice as high as a
column is wide, and stands for twice as many metres.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from rich.text import Text

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.positions import PositionTracks, TrackSource

COLUMNS, ROWS = 61, 16
TRAIL_LENGTH = 200
"""Pictures whose positions are kept."""

ROUND = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0)

NAMES = "0123456789abcdefghijklmnopqrstuvwxyz"


class PlanView:
    """Keeps the trails and draws them."""

    def __init__(self) -> None:
        self._newest: dict[str, PositionTracks] = {}
        self._trails: dict[str, deque[FloatArray]] = {}

    def add(self, topic: str, tracks: PositionTracks) -> None:
        """Take the newest picture of a topic; data that begin again have no past."""
        newest = self._newest.get(topic)
        if newest is None or tracks.stamp < newest.stamp:
            self._trails[topic] = deque(maxlen=TRAIL_LENGTH)
        claims = tracks.established
        placed = np.all(np.isfinite(tracks.state[:, :2]), axis=-1)
        self._newest[topic] = tracks.selected(claims & placed)
        self._trails[topic].append(self._newest[topic].state[:, :2])

    def render(self) -> Text:
        """Return the picture; nothing where there is no established track."""
        trail = np.concatenate([np.empty((0, 2)), *(p for t in self._trails.values() for p in t)])
        if not len(trail):
            return Text("")
        centre, step = _frame(trail)
        cells = [[" "] * COLUMNS for _ in range(ROWS)]
        self._mark(cells, np.zeros((1, 2)), "+", centre, step)
        self._mark(cells, trail, "." * len(trail), centre, step)
        for tracks in self._newest.values():
            fixed = tracks.source == TrackSource.STATIC
            names = "".join(
                "#" if static else NAMES[int(identifier) % len(NAMES)]
                for static, identifier in zip(fixed, tracks.id, strict=True)
            )
            self._mark(cells, tracks.state[:, :2], names, centre, step)
        head = f"north up, {_distance(step * COLUMNS)} wide, centre {_place(centre)}"
        return Text("\n".join([head, *("".join(row) for row in cells)]), no_wrap=True)

    @staticmethod
    def _mark(
        cells: list[list[str]], points: FloatArray, names: str, centre: FloatArray, step: float
    ) -> None:
        columns = np.rint((points[:, 0] - centre[0]) / step).astype(int) + COLUMNS // 2
        rows = ROWS // 2 - np.rint((points[:, 1] - centre[1]) / (2.0 * step)).astype(int)
        for column, row, name in zip(columns, rows, names, strict=True):
            if 0 <= column < COLUMNS and 0 <= row < ROWS:
                cells[row][column] = name


def _frame(points: FloatArray) -> tuple[FloatArray, float]:
    """Return the middle of the picture and the width of a column, m.

    Both are round numbers, so that the picture does not tremble with the tracks.
    """
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    extent = high - low
    needed = max(extent[0] / (COLUMNS - 6), extent[1] / (2.0 * (ROWS - 3)), 1.0)
    decade = 10.0 ** math.floor(math.log10(needed))
    step = next(m * decade for m in ROUND if m * decade >= needed * (1.0 - 1e-9))
    grid = 2.0 * step
    return np.round(0.5 * (low + high) / grid) * grid, float(step)


def _distance(metres: float) -> str:
    return f"{metres / 1000.0:.3g} km" if metres >= 1000.0 else f"{metres:.0f} m"


def _place(centre: FloatArray) -> str:
    return f"{centre[0]:+.0f} east, {centre[1]:+.0f} north"
