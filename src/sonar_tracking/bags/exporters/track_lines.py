"""Lines on a chart from the rows of an export: one line a track.

Of a long track evenly chosen positions are kept, and the last one, so that memory does not grow
with the recording.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from sonar_tracking.bags.exporters.export_rows import ExportRow

MOST_KEPT = 4096
"""Positions kept of one track."""

LineName = tuple[str, int]
"""Topic, and identifier of the track; 0 = own ship."""


@dataclass
class TrackLine:
    """The places of one track in order of time.

    Attributes
    ----------
    points : list of tuple
        Stamp (ns), latitude and longitude (degrees).
    contributors : dict of str to None
        All tracks it was made from, in order of appearance.
    last : dict of str to object
        Cells of its last row.
    """

    points: list[tuple[int, float, float]] = field(default_factory=list)
    contributors: dict[str, None] = field(default_factory=dict)
    last: dict[str, Any] = field(default_factory=dict)
    _stride: int = 1
    _count: int = 0
    _newest: tuple[int, float, float] = (0, math.nan, math.nan)

    def add(self, row: ExportRow) -> None:
        """Take the next row, whose place is known."""
        self._newest = (row.stamp, *row.place)
        self.last = row.values
        for name in filter(None, str(row.values.get("contributors", "")).split(";")):
            self.contributors[name] = None
        if self._count % self._stride == 0:
            self.points.append(self._newest)
        self._count += 1
        if len(self.points) >= MOST_KEPT:
            self.points = self.points[::2]
            self._stride *= 2

    def finish(self) -> None:
        """Let the line end where the track did."""
        if self.points[-1] != self._newest:
            self.points.append(self._newest)

    def parts(self) -> list[list[tuple[int, float, float]]]:
        """Return the points, cut where the track crosses the meridian of 180 degrees."""
        parts = [[self.points[0]]]
        for before, point in zip(self.points, self.points[1:], strict=False):
            if abs(point[2] - before[2]) > 180.0:
                parts.append([])
            parts[-1].append(point)
        return parts


class TrackLines:
    """Lines by topic and track; rows of tracks that claim no target are passed over."""

    def __init__(self) -> None:
        self.lines: dict[LineName, TrackLine] = {}

    def add(self, topic: str, row: ExportRow) -> bool:
        """Take a row of a topic; return whether it is shown."""
        if not row.is_established or not all(map(math.isfinite, row.place)):
            return False
        name = (topic, int(row.values.get("id") or 0))
        self.lines.setdefault(name, TrackLine()).add(row)
        return True

    def finish(self) -> dict[LineName, TrackLine]:
        """Return the lines, whole."""
        for line in self.lines.values():
            line.finish()
        return self.lines
