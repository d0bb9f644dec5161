"""Where the data of a run come from, as the orchestration sees it."""

from __future__ import annotations

import time
from typing import Protocol

IDLE_SECONDS = 1.0
"""Nothing to do before something is heard from the graph."""

BURST = 64
"""Most messages a source lets go before the events of the graph are looked at."""

RESEND_SECONDS = 0.5
"""A tick nobody served for this long was lost: it is published again, s."""


class DataSource(Protocol):
    """Lets data flow into the graph: by moving a simulator's clock, or from a recording."""

    @property
    def finished(self) -> bool:
        """Whether all data have been let go."""
        ...

    @property
    def data_seconds(self) -> float:
        """Data time let go so far, s."""
        ...

    def advance(self, wall: float) -> float:
        """Let go what is due and what the graph can take.

        Parameters
        ----------
        wall : float
            Monotonic wall time, s.

        Returns
        -------
        float
            Seconds until the next call is useful if nothing is heard from the graph.
        """
        ...

    def behind(self, wall: float) -> float:
        """Return how much later than the rate asked for the data are, s of the wall clock."""
        ...

    def resume(self, since: float, wall: float) -> None:
        """Go on after a pause from one wall time to another, which does not count."""
        ...


def let_go(source: DataSource) -> float:
    """Let go all data that are due, some at most; return how long to wait for more, s."""
    for _ in range(BURST):
        wait = source.advance(time.monotonic())
        if wait > 0.0:
            return wait
    return 0.0
