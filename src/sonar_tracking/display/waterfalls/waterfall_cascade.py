"""Time scales of a waterfall: short rows integrated to longer ones.

Power adds, decibels do not. The mean power of a row is that of its parts weighted by the durations
of their data,

    P = sum_i T_i P_i / sum_i T_i,

and each scale takes the rows of the one before it. So the energy of a long row is exactly that of
the short rows within its span, and what is seen on one scale is found again on the others.

Rows end at multiples of their scale in stamp time, with the part that reaches it: parts are not
split. They end earlier where nothing was received for longer than the finest row, where the beams
are others, or where the array has turned too far for one direction to stand for all of the row. A
row says what span it has, and which way the array pointed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sonar_tracking.display.waterfalls.beam_rows import BeamRow
from sonar_tracking.records.time import nanoseconds

SCALES = (1.0, 5.0, 20.0)
"""Of a row, s."""

LARGEST_TURN = math.radians(2.0)
"""Of the array within a row, rad."""


@dataclass(frozen=True)
class ScaledRow:
    """A row of one scale.

    Attributes
    ----------
    scale : float
        s.
    row : BeamRow
        Its mean.
    complete : bool
        False = the data of a later row with the same begin will take its place.
    """

    scale: float
    row: BeamRow
    complete: bool


class WaterfallCascade:
    """Integrates the rows of one array.

    Parameters
    ----------
    scales : tuple of float
        Of a row, s, ascending.
    """

    def __init__(self, scales: tuple[float, ...] = SCALES) -> None:
        self.scales = scales
        self._parts: list[list[BeamRow]] = [[] for _ in scales]
        self._end = 0

    def add(self, row: BeamRow) -> list[ScaledRow]:
        """Take the next row and return the rows it completes, of all scales.

        Parameters
        ----------
        row : BeamRow
            Later than those before it; where time goes back the rows begun are completed.
        """
        longest_gap = nanoseconds(self.scales[0])
        gap = row.begin - self._end if self._end else 0
        broken = gap > longest_gap or gap < -longest_gap // 2
        completed = self.flush() if broken else []
        self._end = row.end
        return completed + self._taken(0, row)

    def flush(self) -> list[ScaledRow]:
        """Complete the rows that have begun."""
        completed: list[ScaledRow] = []
        for level in range(len(self.scales)):
            if self._parts[level]:
                completed += self._completed(level)
        return completed

    def pending(self) -> list[ScaledRow]:
        """Return the rows of all scales but the finest as far as they have come."""
        pending = []
        below: list[BeamRow] = self._parts[0]
        for scale, parts in zip(self.scales[1:], self._parts[1:], strict=True):
            below = [*parts, *below]
            if below and joins(below[:1], below[-1]):
                pending.append(ScaledRow(scale, integrated(below), complete=False))
        return pending

    def _taken(self, level: int, row: BeamRow) -> list[ScaledRow]:
        """Take a row into a scale."""
        parts = self._parts[level]
        completed = [] if not parts or joins(parts, row) else self._completed(level)
        self._parts[level].append(row)
        scale = nanoseconds(self.scales[level])
        reached = row.end // scale > self._parts[level][0].begin // scale
        return completed + (self._completed(level) if reached else [])

    def _completed(self, level: int) -> list[ScaledRow]:
        """Complete the row of a scale, and hand it on to the next one."""
        row = integrated(self._parts[level])
        self._parts[level] = []
        own = [ScaledRow(self.scales[level], row, complete=True)]
        return own + (self._taken(level + 1, row) if level + 1 < len(self.scales) else [])


def integrated(parts: list[BeamRow]) -> BeamRow:
    """Return the mean of rows of the same beams, weighted by the durations of their data.

    Parameters
    ----------
    parts : list of BeamRow
        In order of time, at least one.
    """
    weights = np.array([part.integrated for part in parts])
    total = float(weights.sum())
    shares = weights / total if total > 0.0 else np.full(len(parts), 1.0 / len(parts))
    azimuths = np.array([part.axis_azimuth for part in parts])
    mean = np.sum(shares * np.exp(1j * azimuths))
    return BeamRow(
        begin=parts[0].begin,
        end=parts[-1].end,
        axis=parts[0].axis,
        power=shares @ np.array([part.power for part in parts]),
        integrated=total,
        sensor_id=parts[0].sensor_id,
        axis_azimuth=float(np.angle(mean)),
    )


def joins(parts: list[BeamRow], row: BeamRow) -> bool:
    """Return whether a row has the beams of the first of some rows, and about its direction."""
    first = parts[0]
    turn = math.remainder(row.axis_azimuth - first.axis_azimuth, 2.0 * math.pi)
    unknown = math.isnan(row.axis_azimuth) and math.isnan(first.axis_azimuth)
    return row.axis == first.axis and (unknown or abs(turn) <= LARGEST_TURN)
