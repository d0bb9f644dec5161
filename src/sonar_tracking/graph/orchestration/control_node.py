"""The orchestration's own node: it drives the clock and sees every message of the graph.

It publishes ``/clock`` (and, in a replay, the recorded inputs), listens to ``flow/done`` and
``/diagnostics``, and subscribes to the data topics as raw bytes, for counts, digests, latency,
display and score. What it hears goes into plain objects; decisions are made elsewhere.
"""

from __future__ import annotations

import gc
import math
import re
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from types import TracebackType
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.errors import LONGEST_SENTENCE, InputError, shown
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE, signed
from sonar_tracking.graph.catalogue.topics import (
    CLOCK_TOPIC,
    DIAGNOSTICS_TOPIC,
    PROGRESS_TOPIC,
    TIME_TOPIC,
    Topic,
)
from sonar_tracking.graph.message_writing.field_writing import message_class, time_from_stamp
from sonar_tracking.graph.message_writing.progress_writing import ProgressWriter
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.diagnostics import MATCHED, NEIGHBOURS, UNEXPECTED
from sonar_tracking.graph.node_base.neighbours import Neighbours
from sonar_tracking.graph.node_base.no_generators import do_without_generators
from sonar_tracking.graph.node_base.ready_reports import LOOK_PERIOD
from sonar_tracking.graph.orchestration.finished_stamps import FinishedStamps
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.graph_plan import resolved
from sonar_tracking.graph.orchestration.matched_edges import MatchedEdges
from sonar_tracking.graph.orchestration.run_observer import RunObserver
from sonar_tracking.message_reading.progress_reading import progress_from_bytes

_OBSERVER_DEPTH = 10_000
_COUNT = re.compile(r"[0-9]{1,9}", re.ASCII)


class ControlNode:
    """The ROS side of the orchestration.

    Parameters
    ----------
    ledger : FlowLedger
        Told of every Progress message.
    matched : MatchedEdges
        Told of every readiness report.
    observer : RunObserver
        Told of every data message, and when a producer announces one.
    nodes : collection of str
        Names of the nodes of the graph: what others say on ``/diagnostics`` is not theirs.
    sources : tuple of str
        Nodes that serve the clock.
    naming : GraphNames
        Where the graph is.
    run : str
        Identity of the run: what does not bear it is not believed; empty = nothing bears one.

    Attributes
    ----------
    notices : dict of str to str
        The latest sentence of every status that is, or was, not in order.
    errors : dict of str to str
        The same of errors of the nodes themselves.
    finished : FinishedStamps
        How far each consumer has got.
    """

    def __init__(
        self,
        ledger: FlowLedger,
        matched: MatchedEdges,
        observer: RunObserver,
        nodes: Collection[str],
        sources: tuple[str, ...] = (),
        naming: GraphNames = ROOT_NAMES,
        run: str = "",
    ) -> None:
        self._ledger = ledger
        self._matched = matched
        self._observer = observer
        # Diagnostics call a node by its full name, without the slash before it.
        self._nodes = {naming.of_node(name).removeprefix("/"): name for name in nodes}
        self._signed = {signed(name, run): name for name in nodes}
        self._hardware = {full: signed(full, run) for full in self._nodes}
        control = naming.of_node(CONTROL_NODE).removeprefix("/")
        self._neighbours_by_name = {**self._nodes, control: CONTROL_NODE}
        self._told: int | None = None
        self._looked = -math.inf
        self._has_news = False
        self._observed: dict[str, int] = {}
        self._publishers: dict[str, Publisher] = {}
        self._served: dict[str, int | None] = dict.fromkeys(sources)
        self.notices: dict[str, str] = {}
        self.errors: dict[str, str] = {}
        self.finished = FinishedStamps()
        do_without_generators()
        self._context = Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = Node(
            CONTROL_NODE,
            context=self._context,
            namespace=naming.namespace,
            use_global_arguments=False,
        )
        self._neighbours = Neighbours(self._node)
        self._clock = self._node.create_publisher(Clock, naming.clock, quality_of_service.CLOCK)
        self._time_writer = ProgressWriter(signed(CONTROL_NODE, run), self._clock.topic_name)
        time_topic = naming.of(TIME_TOPIC)
        self._time = self._node.create_publisher(Progress, time_topic, quality_of_service.CLOCK)
        if sources:
            self._publishers[time_topic] = self._time
        self._node.create_subscription(
            Progress,
            naming.of(PROGRESS_TOPIC),
            self._progress,
            quality_of_service.PROGRESS,
            raw=True,
        )
        self._node.create_subscription(
            DiagnosticArray, DIAGNOSTICS_TOPIC, self._diagnostics, quality_of_service.DIAGNOSTICS
        )
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._node)
        # What was loaded stays: collections of garbage need not look at it again and again.
        gc.freeze()

    def __enter__(self) -> ControlNode:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)

    @property
    def served(self) -> int | None:
        """Instant up to which every source has served the clock, ns; None before."""
        instants = [instant for instant in self._served.values() if instant is not None]
        everyone = len(instants) == len(self._served)
        return min(instants) if instants and everyone else None

    def observe(self, topics: Iterable[Topic]) -> None:
        """Subscribe to data topics as raw bytes."""
        for topic in topics:
            self._subscribe(topic)

    def _subscribe(self, topic: Topic) -> None:
        name = resolved(topic)
        self._observed[name] = 0

        def observe(data: Any) -> None:
            self._observe(name, data)

        self._node.create_subscription(
            message_class(topic.message_type),
            name,
            observe,
            quality_of_service.subscription_profile(_OBSERVER_DEPTH),
            raw=True,
        )

    def offer(self, topics: Iterable[Topic], depth: int) -> None:
        """Become the publisher of data topics."""
        for topic in topics:
            name = resolved(topic)
            self._publishers[name] = self._node.create_publisher(
                message_class(topic.message_type),
                name,
                quality_of_service.publisher_profile(topic.kind, depth),
            )

    def hear(self, name: str, message_type: str, take: Callable[[Any], None]) -> None:
        """Hand each message of a topic that is no data of the graph to a callable."""
        self._node.create_subscription(
            message_class(message_type), name, take, quality_of_service.DIAGNOSTICS
        )

    def publish_clock(self, stamp: int) -> None:
        """Tell the graph the time, ns."""
        self._told = stamp
        if self._served:
            self._time.publish(self._time_writer.message(0, stamp))
        self._clock.publish(Clock(clock=time_from_stamp(stamp)))

    def publish(self, topic: str, data: bytes) -> None:
        """Publish a serialised message on a topic offered before."""
        self._publishers[topic].publish(data)

    def alone(self) -> bool:
        """Return whether nobody else publishes topics of the graph."""
        return not self.foreign()

    def foreign(self) -> list[str]:
        """Return the topics that somebody else publishes too, the clock included, and who does."""
        topics = {*self._matched.foreign_publishers()}
        if self.other_clocks():
            topics.add(self._clock.topic_name)
        return [f"{topic} by {', '.join(self.publishers_of(topic))}" for topic in sorted(topics)]

    def other_clocks(self) -> list[str]:
        """Return the full names of the nodes that publish the clock of this graph, too."""
        others = self.publishers_of(self._clock.topic_name)
        own = self._node.get_fully_qualified_name()
        if own in others:
            others.remove(own)
        return others

    def publishers_of(self, topic: str) -> list[str]:
        """Return the full names of the nodes that publish a topic."""
        publishers = self._node.get_publishers_info_by_topic(topic)
        return sorted(shown(f"{p.node_namespace.rstrip('/')}/{p.node_name}") for p in publishers)

    def report_own(self) -> None:
        """Report whom the topics offered before have found, as every node does."""
        wall = time.monotonic()
        if wall - self._looked < LOOK_PERIOD:
            return
        self._looked = wall
        self._neighbours.look(self._publishers)
        counts = {name: each.get_subscription_count() for name, each in self._publishers.items()}
        self._matched.report(CONTROL_NODE, counts)
        self._report_found(CONTROL_NODE, self._neighbours.values())

    def spin_once(self, patience: float) -> None:
        """Handle one event, waiting for it at most ``patience`` seconds."""
        self._executor.spin_once(timeout_sec=patience)

    def spin_until_news(self, patience: float) -> None:
        """Handle events until more data may be let go, at most ``patience`` seconds."""
        deadline = time.monotonic() + patience
        self._has_news = False
        while not self._has_news and (left := deadline - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def _observe(self, topic: str, data: bytes) -> None:
        wall = time.monotonic()
        self._observed[topic] += 1
        try:
            self._observer.observed(topic, data, wall)
        except Exception as error:  # whatever a stranger sends: the run goes on
            self.notices[f"{topic}: unreadable"] = (
                f"{topic}: a message is left out of the figures of the run: "
                f"{shown(str(error), LONGEST_SENTENCE)}"
            )
        if self._ledger.finished(CONTROL_NODE, topic, self._observed[topic]):
            self._has_news = True
        self.finished.finished(CONTROL_NODE, topic, head_stamp(data))

    def _progress(self, data: Any) -> None:
        wall = time.monotonic()
        try:
            told = progress_from_bytes(data)
        except InputError:
            return
        node = self._signed.get(told.node)
        if node is None:
            return
        if told.topic == CLOCK_TOPIC:
            self._take_served(node, told.stamp)
            self._has_news = True
        elif self._ledger.producer(told.topic) == node:
            self._ledger.published(node, told.topic, told.count)
            self._observer.announced(told.topic, told.stamp, wall)
        else:
            self._ledger.finished(node, told.topic, told.count)
            self.finished.finished(node, told.topic, told.stamp)
            self._has_news = True

    def _take_served(self, node: str, stamp: int) -> None:
        """Take how far a source has served the clock, as far as it was told the time."""
        if node in self._served and self._told is not None and stamp <= self._told:
            before = self._served[node]
            self._served[node] = stamp if before is None else max(before, stamp)
            self._ledger.changes += 1

    def _diagnostics(self, message: Any) -> None:
        for status in message.status:
            full_name, _, concern = status.name.partition(": ")
            node = self._nodes.get(full_name)
            if node is None or status.hardware_id != self._hardware[full_name]:
                continue
            counts = _counts(status.values)
            if "rejected" in counts:
                received = counts.get("received", 0)
                self._ledger.note_input(node, concern, received, counts["rejected"])
            if concern == MATCHED:
                self._matched.report(node, counts)
            elif concern == NEIGHBOURS:
                self._report_found(node, counts)
            elif status.level != DiagnosticStatus.OK:
                told = self.errors if concern == UNEXPECTED else self.notices
                told[status.name] = f"{node}: {shown(status.message, LONGEST_SENTENCE)}"

    def _report_found(self, node: str, counts: Mapping[str, object]) -> None:
        found = {}
        for key, count in counts.items():
            topic, _, full_name = key.partition(" ")
            neighbour = self._neighbours_by_name.get(full_name)
            if neighbour is not None and isinstance(count, int):
                found[topic, neighbour] = count
        self._matched.report_found(node, found)


def _counts(values: Iterable[KeyValue]) -> dict[str, int]:
    """Return the counts a status holds; what is none is left out."""
    counts = {item.key: item.value for item in values}
    return {key: int(text) for key, text in counts.items() if _COUNT.fullmatch(text)}
