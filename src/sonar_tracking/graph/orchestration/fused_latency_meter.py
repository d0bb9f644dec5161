"""Latency of the fused list: from the newest data that a list tells of to its message.

A list tells of everything up to its stamp, of earlier stamps as well: the echoes of a ping come in
for seconds after bearings of later stamps. Its data are complete with the contacts of pings, with
the bearings of stations, and with the block that holds the last snapshot of the window of an
estimate, whichever comes last. What an estimate waits for by construction is not counted.
"""

from __future__ import annotations

import math
from array import array

import numpy as np

REMEMBERED = 1024
"""Stamps of which one side only is known."""


class FusedLatencyMeter:
    """Matches fused lists with the data up to their stamps.

    Both may come in any order; a list with data of its stamp is measured when a later one has come.
    """

    def __init__(self) -> None:
        self._completed: dict[int, float] = {}
        self._received: dict[int, float] = {}
        self._newest = -math.inf
        self._latencies = array("d")

    def begin_again(self) -> None:
        """Forget what waits, but not the latencies: stamps are going to return."""
        self._completed.clear()
        self._received.clear()
        self._newest = -math.inf

    def data_published(self, stamp: int, wall: float) -> None:
        """Note data for a stamp (ns) that were published at wall time (s)."""
        self._completed[stamp] = max(wall, self._completed.get(stamp, wall))
        _forget(self._completed)

    def list_received(self, stamp: int, wall: float) -> None:
        """Note the arrival of the list of a stamp (ns) at wall time (s)."""
        self._measure(before=stamp)
        self._received[stamp] = wall
        _forget(self._received)

    def figures(self) -> dict[str, float]:
        """Return p50, p99, ms, and how many lists were measured; empty = none."""
        self._measure()
        if not self._latencies:
            return {}
        median, high = np.percentile(np.array(self._latencies) * 1e3, [50, 99])
        return {
            "fused_p50": float(median),
            "fused_p99": float(high),
            "fused_count": len(self._latencies),
        }

    def _measure(self, before: float = math.inf) -> None:
        """Measure the lists before a stamp, ns, for which data have come."""
        ready = [one for one in self._received if one < before and one in self._completed]
        for stamp in sorted(ready):
            for earlier in [one for one in self._completed if one <= stamp]:
                self._newest = max(self._newest, self._completed.pop(earlier))
            self._latencies.append(self._received.pop(stamp) - self._newest)


def _forget(stamps: dict[int, float]) -> None:
    while len(stamps) > REMEMBERED:
        del stamps[next(iter(stamps))]
