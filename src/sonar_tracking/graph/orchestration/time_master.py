"""The time master: decides when the clock of the graph moves, and by how much.

Time moves in steps of one block. It waits for wall time (real time, or faster by a factor) and for
the slowest consumer: blocks between the clock and that consumer never exceed the flow window, so
that no queue in the graph overflows whatever the load. No ROS, no sleeping: it is told the wall
time and answers.
"""

from __future__ import annotations

import math

from sonar_tracking.records.time import NANOSECONDS


class TimeMaster:
    """Paces the clock from ``start`` to ``end``.

    Parameters
    ----------
    start, end : int
        First and last instant of the clock, ns.
    step : int
        Length of a block, ns.
    flow_window : int
        Most blocks between the clock and the slowest consumer.
    rate : float
        Data seconds per wall second; infinity = as fast as the graph takes it.
    """

    def __init__(self, start: int, end: int, step: int, flow_window: int, rate: float) -> None:
        self._start = start
        self._end = end
        self._step = step
        self._flow_window = flow_window
        self._rate = rate
        self._clock: int | None = None
        self._anchor: tuple[float, int] | None = None

    @property
    def clock(self) -> int | None:
        """The last instant told to the graph, ns; None before the first."""
        return self._clock

    @property
    def at_end(self) -> bool:
        """Whether the clock has reached its end."""
        return self._clock is not None and self._clock >= self._end

    def next_tick(self, wall: float, served: int | None, backlog: int) -> int | None:
        """Return the instant the clock moves to now, or None if it has to wait.

        Parameters
        ----------
        wall : float
            Monotonic wall time, s.
        served : int or None
            Instant up to which the source has published its data, ns; None before the first.
        backlog : int
            Messages the slowest consumer has not finished.
        """
        if self.at_end:
            return None
        if self._clock is None:
            self._anchor = (wall, self._start)
            self._clock = self._start
            return self._clock
        due = self._due(wall)
        allowed = self._clock + self._step * (
            self._flow_window - backlog - self._unserved_blocks(served)
        )
        target = min(due, allowed, self._end)
        whole_steps = (target - self._start) // self._step
        tick = self._end if target == self._end else self._start + whole_steps * self._step
        least = self._clock + self._step
        if math.isinf(self._rate):
            # Half a window at a time: every tick is a message to all, and an answer.
            least = self._clock + max(1, self._flow_window // 2) * self._step
        if tick < least and tick < self._end:
            return None
        self._clock = tick
        return tick

    def wall_seconds_to_next(self, wall: float) -> float:
        """Return how long until the next step is due by wall time, s; 0 at full speed."""
        if math.isinf(self._rate) or self._anchor is None or self._clock is None:
            return 0.0
        anchor_wall, anchor_clock = self._anchor
        following = min(self._clock + self._step, self._end)
        ahead = (following - anchor_clock) / NANOSECONDS / self._rate
        return max(0.0, anchor_wall + ahead - wall)

    def behind(self, wall: float) -> float:
        """Return by how much more than a step the clock is late, s of wall time; 0 at full speed.

        Past the end of the data it is the time since they were due.
        """
        if math.isinf(self._rate) or self._anchor is None or self._clock is None:
            return 0.0
        anchor_wall, anchor_clock = self._anchor
        reached = (self._clock + self._step - anchor_clock) / NANOSECONDS / self._rate
        return max(0.0, wall - anchor_wall - reached)

    def resume(self, since: float, wall: float) -> None:
        """Go on after a pause from one wall time to another, which does not count."""
        if self._anchor is not None:
            anchor_wall, anchor_clock = self._anchor
            self._anchor = (anchor_wall + wall - since, anchor_clock)

    def _due(self, wall: float) -> int:
        if math.isinf(self._rate) or self._anchor is None:
            return self._end
        anchor_wall, anchor_clock = self._anchor
        # A nanosecond of slack: the sum of wall times is rounded.
        elapsed = (wall - anchor_wall) * self._rate * NANOSECONDS
        return min(self._end, anchor_clock + round(elapsed) + 1)

    def _unserved_blocks(self, served: int | None) -> int:
        if self._clock is None:
            return 0
        reached = self._start if served is None else served
        behind = max(0, self._clock - reached)
        return -(-behind // self._step) + (1 if served is None else 0)
