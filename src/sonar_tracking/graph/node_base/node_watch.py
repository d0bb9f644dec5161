"""What a node watches besides its data: who is connected, what stalls, who else publishes."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from itertools import pairwise

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from sonar_tracking.errors import Severity
from sonar_tracking.graph.catalogue.topics import CLOCK_TOPIC, COMMANDS, TIME_TOPIC
from sonar_tracking.graph.node_base.data_flow import (
    DataInput,
    DataOutput,
    input_concern,
)
from sonar_tracking.graph.node_base.diagnostics import MATCHED, Diagnostics
from sonar_tracking.graph.node_base.neighbours import full_name
from sonar_tracking.graph.node_base.progress_reporter import ProgressReporter
from sonar_tracking.graph.node_base.ready_reports import ReadyReports
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

STATUS_PERIOD = 1.0
"""Between looks, and publications, once data flow, s of the node's clock."""

ASKING_PERIOD = NANOSECONDS
"""Between two questions who publishes the inputs, and no sooner, ns of steady time: data may flow
many times faster than real time, but the graph changes as people and processes do."""

STALLED_PERIODS = 5
STALLED_AT_LEAST = 2 * NANOSECONDS
"""An input is stalled after so many of its periods, and not before this, ns of the node's clock."""
STALLED_AT_START = 30 * NANOSECONDS
"""The same while its period is not known yet."""
STALLED_STEPS = 10
"""Nor before so many steps of the clock: it leads the slowest node by several of them."""
STALLED_REALLY = NANOSECONDS
"""Nor before so much steady time, ns: where data flow many times faster than real time, the clock
is far ahead of a node that was without a processor for an instant, and of what it publishes."""
REMEMBERED_STEPS = 5
DISCOVERY = 3 * NANOSECONDS
"""So long after its start a node may not know yet who publishes what it listens to, ns."""


class NodeWatch:
    """Publishes the state of a node at its times, and finds stalled and doubled inputs.

    Parameters
    ----------
    node : Node
        The node to watch.
    inputs, outputs : list
        Its data topics; they may still become more.
    diagnostics : Diagnostics
        Where its state is reported.
    progress : ProgressReporter
        Its publisher on ``flow/done``.
    warm_up : callable
        Called once, between the connection of the node and its first data.
    waiting_for : callable
        Tells whether data wait for an input; none may be silent then.
    release : callable
        Called now and then: lets data go that wait for something that does not come.
    """

    def __init__(
        self,
        node: Node,
        inputs: list[DataInput],
        outputs: list[DataOutput],
        diagnostics: Diagnostics,
        progress: ProgressReporter,
        warm_up: Callable[[], None],
        waiting_for: Callable[[DataInput], bool],
        release: Callable[[], None],
    ) -> None:
        self._node = node
        self._waiting_for = waiting_for
        self._release = release
        self._by_clock_topic = bool(node.get_parameter("use_sim_time").value)
        self._clock_topic = node.resolve_topic_name(CLOCK_TOPIC)
        self._time_topic = node.resolve_topic_name(TIME_TOPIC)
        self._commands_topic = node.resolve_topic_name(COMMANDS.name)
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._started = self._steady.now().nanoseconds
        self._inputs = inputs
        self._outputs = outputs
        self._diagnostics = diagnostics
        self._progress = progress
        self._asked = self._started
        self._seen: dict[str, tuple[int, int, int]] = {}
        self._instants: deque[int] = deque(maxlen=REMEMBERED_STEPS + 1)
        diagnostics.add(MATCHED, self._matched_endpoints)
        ReadyReports(node, diagnostics, self._matched_endpoints, self._data_flow, warm_up)
        node.create_timer(STATUS_PERIOD, self._watch)

    def may_not_know_all(self) -> bool:
        """Return whether the node has just come into a graph that runs without it.

        Where ``/clock`` drives the graph, data begin when everybody knows everybody.
        """
        return not self._by_clock_topic and (
            self._steady.now().nanoseconds - self._started < DISCOVERY
        )

    def check_publishers(self, source: DataInput) -> None:
        """Report an input that more than one node publishes."""
        # The name of an endpoint arrives a little later than the endpoint itself.
        publishers = self._node.get_publishers_info_by_topic(source.name)
        names = sorted(full_name(info) for info in publishers if "UNKNOWN" not in info.node_name)
        severity, remedy = Severity.OK, ""
        if len(set(names)) > 1:
            severity, remedy = Severity.ERROR, "stop all but one"
        elif len(names) > 1:
            # A node that was killed and started again is listed twice until its lease ends.
            severity, remedy = Severity.WARN, "unless one was killed just now, stop all but one"
        sentence = (
            f"{source.name} has {len(names)} publishers: {', '.join(names)}; data that do not "
            f"continue those of the first are rejected; {remedy}, or give each its own namespace."
        )
        concern = input_concern(source)
        self._diagnostics.report(concern, "publishers", severity, sentence, lasting=True)

    def _data_flow(self) -> bool:
        received = any(source.received for source in self._inputs)
        return received or any(output.count for output in self._outputs)

    def _watch(self) -> None:
        now = self._node.get_clock().now().nanoseconds
        self._instants.append(now)
        steady = self._steady.now().nanoseconds
        asks = steady - self._asked >= ASKING_PERIOD
        if asks:
            self._asked = steady
        for source in self._inputs:
            if asks:
                self.check_publishers(source)
            self._check_stalled(source, now, steady)
        self._release()
        self._diagnostics.publish_if_due()

    def _check_stalled(self, source: DataInput, now: int, steady: int) -> None:
        received, since, really_since = self._seen.get(source.name, (-1, now, steady))
        if source.received != received or now < since:
            self._seen[source.name] = (source.received, now, steady)
            since, really_since = now, steady
        patience = max(STALLED_PERIODS * source.period, STALLED_AT_LEAST)
        if not source.period:
            patience = STALLED_AT_START
        patience = max(patience, STALLED_STEPS * self._clock_step())
        stalled = (
            now - since > patience
            and steady - really_since > STALLED_REALLY
            and source.guard.expected != END_OF_DATA
        )
        severity = Severity.WARN if stalled and self._waiting_for(source) else Severity.OK
        by = f" of {self._clock_topic}" if self._by_clock_topic else ""
        sentence = (
            f"{source.name}: nothing received for {(now - since) / NANOSECONDS:.1f} s{by}; "
            "check that its publisher is running and connected."
        )
        self._diagnostics.report(input_concern(source), "stalled", severity, sentence, lasting=True)

    def _matched_endpoints(self) -> dict[str, object]:
        """Return the matched remote endpoints of every data topic and of those of the flow."""
        counts: dict[str, object] = {}
        for source in self._inputs:
            counts[source.name] = source.subscription.get_publisher_count()
        for publisher in [output.publisher for output in self._outputs]:
            counts[publisher.topic_name] = publisher.get_subscription_count()
        flow = self._progress.publisher
        counts[flow.topic_name] = flow.get_subscription_count()
        counts[self._clock_topic] = clock_publishers(self._node)
        for subscription in self._node.subscriptions:
            if subscription.topic_name == self._time_topic:
                counts[self._time_topic] = subscription.get_publisher_count()
            elif subscription.topic_name == self._commands_topic:
                # Where nobody is there to give commands, no node waits for that.
                publishers = subscription.get_publisher_count()
                counts |= {self._commands_topic: publishers} if publishers else {}
        return counts

    def _clock_step(self) -> int:
        """Return the usual step of /clock, ns: the median, since a clock may jump once."""
        steps = sorted(later - now for now, later in pairwise(self._instants))
        return max(0, steps[len(steps) // 2]) if steps else 0


def clock_publishers(node: Node) -> int:
    """Return how many publishers every subscription of a node to the clock is matched with."""
    clock = node.resolve_topic_name(CLOCK_TOPIC)
    clocks = [s for s in node.subscriptions if s.topic_name == clock]
    return min((s.get_publisher_count() for s in clocks), default=0)
