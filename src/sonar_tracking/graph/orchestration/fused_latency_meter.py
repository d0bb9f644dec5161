"""Latency of the fused list: from the last data that one of its frames needs to its message.

Data are complete for a stamp with the contacts of its ping, with the bearings that a station sends
then, and with the block that holds the last snapshot of the window of its estimate, whichever comes
last. What an estimate waits for by construction is not counted.
"""

from __future__ import annotations

from array import array

import numpy as np

REMEMBERED = 1024
"""Stamps of which one side only is known."""


class FusedLatencyMeter:
    """Matches fused lists with the data of the same stamp.

    Both sides of a stamp may come in any order; a list is measured when a later one has come.
    """

    def __init__(self) -> None:
        self._completed: dict[int, float] = {}
        self._received: dict[int, float] = {}
        self._latencies = array("d")

    def begin_again(self) -> None:
        """Forget what waits, but not the latencies: stamps are going to return."""
        self._completed.clear()
        self._received.clear()

    def data_published(self, stamp: int, wall: float) -> None:
        """Note data for a stamp (ns) that were published at wall time (s)."""
        self._completed[stamp] = max(wall, self._completed.get(stamp, wall))
        _forget(self._completed)

    def list_received(self, stamp: int, wall: float) -> None:
        """Note the arrival of the list of a stamp (ns) at wall time (s)."""
        for before in [one for one in self._received if one < stamp and one in self._completed]:
            self._measure(before)
        self._received[stamp] = wall
        _forget(self._received)

    def figures(self) -> dict[str, float]:
        """Return p50, p99, ms, and how many lists were measured; empty = none."""
        for stamp in [one for one in self._received if one in self._completed]:
            self._measure(stamp)
        if not self._latencies:
            return {}
        median, high = np.percentile(np.array(self._latencies) * 1e3, [50, 99])
        return {
            "fused_p50": float(median),
            "fused_p99": float(high),
            "fused_count": len(self._latencies),
        }

    def _measure(self, stamp: int) -> None:
        self._latencies.append(self._received.pop(stamp) - self._completed.pop(stamp))


def _forget(stamps: dict[int, float]) -> None:
    while len(stamps) > REMEMBERED:
        del stamps[next(iter(stamps))]
