"""Merges the inputs of a node in event time, so that results do not depend on arrival order.

Pure stamps: no ROS, no clock, no timeout. Three kinds of inputs:

- *streams* are independent. Their items run in (stamp, topic name) order; an item runs once no
  other stream can still bring an earlier one, which its watermark (``next_stamp``) tells.
- *groups* are streams made from the same datum: items with the same stamp run together; a member
  whose watermark has passed the stamp is absent.
- *series* are continuous quantities such as odometry. An item at t waits for a sample at or after
  t and gets the value interpolated at t.

The order of stamps within one topic must be rising: see
:class:`sonar_tracking.graph.node_base.stamp_guard.StampGuard`.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sonar_tracking.records.time import END_OF_DATA, UNKNOWN_STAMP

CAPACITY = 2000
"""Items that wait for an input that is late, before they no longer do."""

Interpolation = Callable[[Any, Any, float], Any]
"""``interpolate(before, after, fraction)`` with fraction from 0 to 1."""


@dataclass(frozen=True)
class JoinedItem:
    """What runs at one instant.

    Attributes
    ----------
    stamp : int
        The instant, ns.
    topic : str
        The stream, or the first topic by name of the group.
    items : dict of str to object
        Item of each topic; an absent member of a group has no entry.
    series : dict of str to object
        Value of each series at the stamp; None = not known there.
    not_awaited : tuple of str
        Topics that could still have brought something, but too much was waiting for them.
    """

    stamp: int
    topic: str
    items: dict[str, Any]
    series: dict[str, Any] = field(default_factory=dict)
    not_awaited: tuple[str, ...] = ()


class EventTimeJoin:
    """Puts the items of several inputs into one order that only their stamps decide.

    Parameters
    ----------
    streams : sequence of str
        Topics of independent streams.
    groups : sequence of sequence of str
        Topics that share stamps, per group.
    series : mapping of str to callable
        Topics of time series, each with its interpolation.
    capacity : int
        Most items that wait; beyond it the earliest runs without what it waits for.
    needs_series : callable, optional
        Tells of what is to run together (item by topic) whether it waits for the series; default:
        everything does. What does not wait gets whatever is known of them.
    """

    def __init__(
        self,
        streams: Sequence[str] = (),
        groups: Sequence[Sequence[str]] = (),
        series: Mapping[str, Interpolation] | None = None,
        capacity: int = CAPACITY,
        needs_series: Callable[[dict[str, Any]], bool] | None = None,
    ) -> None:
        lanes = [_Lane((topic,)) for topic in streams] + [_Lane(group) for group in groups]
        self._lanes = sorted(lanes, key=lambda lane: lane.name)
        self._lane_of = {topic: lane for lane in lanes for topic in lane.topics}
        self._has_one_input = len(self._lane_of) == 1 and not series
        self._capacity = capacity
        self._needs_series = needs_series
        self._series = {topic: _Series(function) for topic, function in (series or {}).items()}

    def push(self, topic: str, stamp: int, next_stamp: int, item: Any) -> tuple[JoinedItem, ...]:
        """Take one item and return everything that may run now, in order.

        Parameters
        ----------
        topic : str
            Where it came from.
        stamp, next_stamp : int
            Of the item, ns; next_stamp 0 = unknown.
        item : object
            Whatever it is.

        Returns
        -------
        tuple of JoinedItem
        """
        if self._has_one_input and stamp < END_OF_DATA:
            # There is nothing to wait for.
            return (JoinedItem(stamp, topic, {topic: item}),)
        if topic in self._series:
            self._series[topic].append(stamp, next_stamp, item)
        else:
            self._lane_of[topic].append(topic, stamp, next_stamp, item)
        return self.released()

    def released(self) -> tuple[JoinedItem, ...]:
        """Return everything that may run now, in order: who needs a series may have changed."""
        return tuple(self._released(flush=False))

    def flush(self, kept: Collection[str] = ()) -> tuple[JoinedItem, ...]:
        """Return everything that still waits, in order, and forget all state.

        Parameters
        ----------
        kept : collection of str
            Topics of series whose samples stay: they belong to what follows.
        """
        rest = tuple(self._released(flush=True))
        for lane in self._lanes:
            lane.clear()
        for topic, series in self._series.items():
            if topic not in kept:
                series.clear()
        return rest

    def waits_for(self) -> tuple[str, ...]:
        """Return the topics that keep the earliest waiting item from running."""
        lane = self._earliest()
        if lane is None:
            return ()
        stamp = lane.head_stamp()
        topics: list[str] = []
        if self._needs_series is None or self._needs_series(lane.peek(stamp)):
            topics += [name for name, series in self._series.items() if not series.covers(stamp)]
        for other in self._lanes:
            if other is lane:
                topics += lane.missing(stamp)
            elif not self._precedes(lane, stamp, other):
                topics += other.lagging(stamp)
        return tuple(sorted(topics))

    def _released(self, flush: bool) -> Iterator[JoinedItem]:
        while (lane := self._earliest()) is not None:
            awaited = self.waits_for()
            full = sum(each.waiting() for each in self._lanes) > self._capacity
            if awaited and not flush and not full:
                return
            stamp = lane.head_stamp()
            values = {topic: series.at(stamp) for topic, series in self._series.items()}
            yield JoinedItem(stamp, lane.name, lane.take(stamp), values, () if flush else awaited)
            needed = min(each.bound() for each in self._lanes)
            for series in self._series.values():
                series.forget_before(needed)

    def _earliest(self) -> _Lane | None:
        waiting = [lane for lane in self._lanes if lane.head_stamp() < END_OF_DATA]
        return min(waiting, key=lambda lane: (lane.head_stamp(), lane.name), default=None)

    @staticmethod
    def _precedes(lane: _Lane, stamp: int, other: _Lane) -> bool:
        return (stamp, lane.name) < (other.bound(), other.name)


class _Lane:
    """One stream, or one group of topics that share stamps."""

    def __init__(self, topics: Sequence[str]) -> None:
        self.topics = tuple(sorted(topics))
        self.name = self.topics[0]
        self.clear()

    def clear(self) -> None:
        self._queues: dict[str, deque[tuple[int, Any]]] = {name: deque() for name in self.topics}
        self._watermarks = dict.fromkeys(self.topics, UNKNOWN_STAMP)

    def append(self, topic: str, stamp: int, next_stamp: int, item: Any) -> None:
        self._queues[topic].append((stamp, item))
        self._watermarks[topic] = max(next_stamp, stamp + 1)

    def head_stamp(self) -> int:
        """Stamp of the earliest waiting item; END_OF_DATA = none waits."""
        return min((queue[0][0] for queue in self._queues.values() if queue), default=END_OF_DATA)

    def waiting(self) -> int:
        """Count the items that wait."""
        return sum(map(len, self._queues.values()))

    def bound(self) -> int:
        """Nothing earlier than this can come out of the lane any more."""
        return min(self._bound_of(topic) for topic in self.topics)

    def missing(self, stamp: int) -> list[str]:
        """Topics that may still bring an item at or before the stamp."""
        return [
            topic
            for topic in self.topics
            if not self._queues[topic] and self._watermarks[topic] <= stamp
        ]

    def lagging(self, stamp: int) -> list[str]:
        """Topics of this lane that hold up an item of another lane at the stamp."""
        return [topic for topic in self.topics if self._bound_of(topic) <= stamp]

    def peek(self, stamp: int) -> dict[str, Any]:
        """Items at the stamp, which stay where they are."""
        return {
            topic: queue[0][1]
            for topic, queue in self._queues.items()
            if queue and queue[0][0] == stamp
        }

    def take(self, stamp: int) -> dict[str, Any]:
        return {
            topic: queue.popleft()[1]
            for topic, queue in self._queues.items()
            if queue and queue[0][0] == stamp
        }

    def _bound_of(self, topic: str) -> int:
        queue = self._queues[topic]
        return queue[0][0] if queue else self._watermarks[topic]


class _Series:
    """Samples of a continuous quantity, oldest first."""

    def __init__(self, interpolate: Interpolation) -> None:
        self._interpolate = interpolate
        self.clear()

    def clear(self) -> None:
        self._stamps: list[int] = []
        self._values: list[Any] = []
        self._watermark = UNKNOWN_STAMP

    def append(self, stamp: int, next_stamp: int, value: Any) -> None:
        self._stamps.append(stamp)
        self._values.append(value)
        self._watermark = next_stamp

    def covers(self, stamp: int) -> bool:
        """Whether no later sample can change the value at the stamp."""
        reached = bool(self._stamps) and self._stamps[-1] >= stamp
        return reached or self._watermark == END_OF_DATA

    def at(self, stamp: int) -> Any:
        """Value at the stamp; None outside the samples."""
        after = bisect_left(self._stamps, stamp)
        if after == len(self._stamps):
            return None
        if self._stamps[after] == stamp:
            return self._values[after]
        if after == 0:
            return None
        start, end = self._stamps[after - 1], self._stamps[after]
        fraction = (stamp - start) / (end - start)
        return self._interpolate(self._values[after - 1], self._values[after], fraction)

    def forget_before(self, stamp: int) -> None:
        """Drop the samples no item at or after the stamp needs."""
        unneeded = max(0, bisect_left(self._stamps, stamp + 1) - 1)
        del self._stamps[:unneeded], self._values[:unneeded]
