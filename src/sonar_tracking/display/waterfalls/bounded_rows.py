"""Rows of a picture in bounded memory: of too many, neighbours are integrated to one."""

from __future__ import annotations

from sonar_tracking.display.waterfalls.beam_rows import BeamRow
from sonar_tracking.display.waterfalls.waterfall_cascade import integrated, joins


class BoundedRows:
    """Rows of beam power, in order of time.

    Parameters
    ----------
    most : int
        Up to so many are kept as they are.
    """

    def __init__(self, most: int) -> None:
        self._limit = most
        self.rows: list[BeamRow] = []

    def add(self, row: BeamRow) -> None:
        """Take the next row; where there are too many, pairs without a gap become one."""
        self.rows.append(row)
        if len(self.rows) <= self._limit:
            return
        before, self.rows, fresh = self.rows, [], True
        for each in before:
            # A row that was joined in this pass is left alone: all become longer alike.
            last = self.rows[-1:]
            if not fresh and joins(last, each) and last[0].end >= each.begin:
                self.rows[-1] = integrated([*last, each])
                fresh = True
            else:
                self.rows.append(each)
                fresh = False
        # Gaps and turns may leave more rows than wanted.
        self._limit = max(self._limit, len(self.rows) + len(self.rows) // 2)
