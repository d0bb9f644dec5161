"""Latency of the chain: from the block that completes an estimate to its track message.

The block that completes an estimate is the one that holds the last snapshot of the estimate's
window. What the estimate waits for by construction (snapshots after its sample time) is the
algorithmic delay and is reported apart.
"""

from __future__ import annotations

import bisect
import math
from array import array
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.time import nanoseconds

REMEMBERED_BLOCKS = 4096
STAMP_TOLERANCE_NS = 1000


@dataclass(frozen=True)
class LatencySummary:
    """Latencies of a run.

    Attributes
    ----------
    median, percentile_99 : float
        Wall time from the completing block to the track message, ms; NaN = none measured.
    algorithmic : float
        Snapshots an estimate waits for after its sample time, ms; NaN = unknown.
    count : int
        Track messages measured.
    first : float
        Of the first track message, ms; NaN = none measured.
    """

    median: float
    percentile_99: float
    algorithmic: float
    count: int
    first: float = math.nan


class LatencyMeter:
    """Matches track messages with the blocks that made them possible.

    The three kinds of event may arrive in any order.
    """

    def __init__(self) -> None:
        self._block_stamps = array("q")
        self._block_walls = array("d")
        self._window_ends: dict[int, int] = {}
        self._track_walls: dict[int, float] = {}
        self._latencies = array("d")
        self._algorithmic = math.nan

    def block_published(self, stamp: int, wall: float) -> None:
        """Note the publication of a block that starts at ``stamp`` (ns) at wall time (s)."""
        if self._block_stamps and stamp <= self._block_stamps[-1]:
            return
        self._block_stamps.append(stamp)
        self._block_walls.append(wall)
        if len(self._block_stamps) > 2 * REMEMBERED_BLOCKS:
            del self._block_stamps[:REMEMBERED_BLOCKS]
            del self._block_walls[:REMEMBERED_BLOCKS]

    def published_at(self, stamp: int) -> float:
        """Return when the block with the data of a stamp (ns) was published, s; NaN = unknown."""
        block = bisect.bisect_right(self._block_stamps, stamp + STAMP_TOLERANCE_NS) - 1
        return self._block_walls[block] if block >= 0 else math.nan

    def begin_again(self) -> None:
        """Forget blocks and tracks, but not the latencies: their stamps are going to return."""
        del self._block_stamps[:], self._block_walls[:]
        self._window_ends.clear()
        self._track_walls.clear()

    def estimate_described(self, stamp: int, last_offset: float) -> None:
        """Note an estimate and the time of its newest snapshot relative to its stamp, s."""
        self._window_ends[stamp] = stamp + nanoseconds(last_offset)
        # The last window of the data may be cut short: the longest is what estimates wait for.
        self._algorithmic = float(np.fmax(self._algorithmic, last_offset * 1e3))
        self._match(stamp)

    def tracks_received(self, stamp: int, wall: float) -> None:
        """Note the arrival of the track message of an estimate at wall time (s)."""
        self._track_walls[stamp] = wall
        self._match(stamp)

    def _match(self, stamp: int) -> None:
        if stamp not in self._window_ends or stamp not in self._track_walls:
            return
        window_end = self._window_ends.pop(stamp)
        wall = self._track_walls.pop(stamp)
        published = self.published_at(window_end)
        if not math.isnan(published):
            self._latencies.append(wall - published)

    def summary(self) -> LatencySummary:
        """Return the latencies so far."""
        if not self._latencies:
            return LatencySummary(math.nan, math.nan, self._algorithmic, 0)
        median, high = np.percentile(np.array(self._latencies) * 1e3, [50, 99])
        return LatencySummary(
            median=float(median),
            percentile_99=float(high),
            algorithmic=self._algorithmic,
            count=len(self._latencies),
            first=1e3 * self._latencies[0],
        )
