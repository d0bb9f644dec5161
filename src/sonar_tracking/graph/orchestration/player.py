"""Data from a recording: its inputs are published as they were, with ``/clock``."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.bags.contents.storage_file import BagMessage
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE
from sonar_tracking.graph.orchestration.command_desk import CommandDesk
from sonar_tracking.graph.orchestration.control_node import ControlNode
from sonar_tracking.graph.orchestration.data_source import IDLE_SECONDS
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.records.time import NANOSECONDS

CLOCK_PERIOD = NANOSECONDS // 10
FULL_SPEED_CLOCK_PERIOD = NANOSECONDS // 2
"""Data time between two clock messages, ns; fewer at full speed, where each is one of many."""

Sink = Callable[[BagMessage], None]
Published = Callable[[str, bytes, float], None]


class Player:
    """Publishes the inputs of a recording, no faster than the graph takes them.

    Parameters
    ----------
    control : ControlNode
        Publishes; the inputs were offered before.
    ledger : FlowLedger
        Knows what the nodes still have to do, and is told of everything published.
    messages : iterable of BagMessage
        In log order; times that go back begin the recording again.
    inputs : set of str
        Topics to publish in time; they drive ``/clock``.
    truth : set of str
        Topics to publish beside them, as soon as the inputs recorded before are out: what was
        true may begin long before the data and last longer, and must not stretch the replay.
    sink : callable
        Takes the messages of all other topics: recorded outputs.
    published : callable
        Called with topic, message and wall time of everything published.
    flow_window : int
        Most messages of a topic between the player and the slowest consumer.
    rate : float
        Data seconds per wall second; infinity = as fast as the graph takes it.
    desk : CommandDesk
        Of operators: those of the recording go out through it, too.
    """

    def __init__(
        self,
        control: ControlNode,
        ledger: FlowLedger,
        messages: Iterable[BagMessage],
        inputs: set[str],
        truth: set[str],
        sink: Sink,
        published: Published,
        flow_window: int,
        rate: float,
        desk: CommandDesk,
    ) -> None:
        self._control = control
        self._ledger = ledger
        self._messages: Iterator[BagMessage] = iter(messages)
        self._inputs = inputs
        self._truth = truth
        self._sink = sink
        self._published = published
        self._flow_window = flow_window
        self._rate = rate
        self._desk = desk
        self._newest: int | None = None
        self._clock_period = FULL_SPEED_CLOCK_PERIOD if math.isinf(rate) else CLOCK_PERIOD
        self._counts = dict.fromkeys(inputs | truth, 0)
        self._next: BagMessage | None = None
        self._exhausted = False
        self._first: int | None = None
        self._last = 0
        self._earlier_passes = 0
        self._clock = 0
        self._anchor: tuple[float, int] | None = None
        self._fetch()

    @property
    def finished(self) -> bool:
        """Whether every input and all truth were published."""
        return self._exhausted

    @property
    def commanded(self) -> bool:
        """Whether operators have given commands that the recording does not hold."""
        return self._desk.given > 0

    @property
    def data_seconds(self) -> float:
        """Data time published so far, s."""
        if self._first is None:
            return 0.0
        return (self._earlier_passes + self._last - self._first) / NANOSECONDS

    def advance(self, wall: float) -> float:
        """Publish the next message if it is due and the graph can take it."""
        if self._desk.holds(self._newest, wall):
            return IDLE_SECONDS
        message = self._next
        if message is None or self._ledger.largest_backlog() >= self._flow_window:
            return IDLE_SECONDS
        if message.topic in self._inputs:
            if message.log_time < self._last:
                if self._ledger.largest_backlog() > 0:
                    return IDLE_SECONDS
                self._begin_again(message.log_time, wall)
            early = self._wall_seconds_early(message.log_time, wall)
            if early > 0.0:
                return early
            self._advance_clock(message.log_time)
        self._publish(message, wall)
        self._fetch()
        return 0.0

    def behind(self, wall: float) -> float:
        """Return how much later than the rate asked for the data are, s of the wall clock."""
        if self._anchor is None:
            return 0.0
        following = self._next
        due = self._last
        if following is not None and following.topic in self._inputs:
            due = following.log_time
        return max(0.0, -self._wall_seconds_early(due, wall))

    def resume(self, since: float, wall: float) -> None:
        """Go on after a pause from one wall time to another, which does not count."""
        if self._anchor is not None:
            anchor_wall, anchor_time = self._anchor
            self._anchor = (anchor_wall + wall - since, anchor_time)

    def _begin_again(self, log_time: int, wall: float) -> None:
        """Take the time of a message for the begin of another pass."""
        self._desk.begin_again()
        self._newest = None
        self._earlier_passes += self._last - (self._first or 0)
        self._first = self._last = log_time
        self._anchor = (wall, log_time)

    def _advance_clock(self, log_time: int) -> None:
        if self._first is None:
            self._first = log_time
        self._last = max(self._last, log_time)
        if self._clock == 0 or abs(log_time - self._clock) >= self._clock_period:
            self._clock = log_time
            self._control.publish_clock(self._clock)

    def _publish(self, message: BagMessage, wall: float) -> None:
        if message.topic == self._desk.topic:
            self._desk.let_out(message.data, wall)
            return
        if message.topic in self._inputs:
            self._newest = max(self._newest or 0, head_stamp(message.data))
        self._counts[message.topic] += 1
        self._ledger.published(CONTROL_NODE, message.topic, self._counts[message.topic])
        self._control.publish(message.topic, message.data)
        self._published(message.topic, message.data, wall)

    def _wall_seconds_early(self, log_time: int, wall: float) -> float:
        if math.isinf(self._rate):
            return 0.0
        if self._anchor is None:
            self._anchor = (wall, log_time)
        anchor_wall, anchor_time = self._anchor
        return anchor_wall + (log_time - anchor_time) / NANOSECONDS / self._rate - wall

    def _fetch(self) -> None:
        """Find the next message to publish; everything else on the way goes to the sink."""
        for message in self._messages:
            if message.topic in self._counts:
                self._next = message
                return
            self._sink(message)
        self._next = None
        self._exhausted = True
