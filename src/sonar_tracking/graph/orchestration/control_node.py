"""The orchestration's own node: it drives the clock and sees every message of the graph.

It publishes ``/clock`` (and, in a replay, the recorded inputs), listens to ``flow/done`` and
``/diagnostics``, and subscribes to the data topics as raw bytes, for counts, digests, latency,
display and score. What it hears goes into plain objects; decisions are made elsewhere.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Iterable
from types import TracebackType
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.topics import (
    CLOCK_TOPIC,
    DIAGNOSTICS_TOPIC,
    PROGRESS_TOPIC,
    Topic,
)
from sonar_tracking.graph.message_writing.field_writing import message_class, time_from_stamp
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.diagnostics import MATCHED, UNEXPECTED
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.graph_plan import CONTROL_NODE, resolved
from sonar_tracking.graph.orchestration.matched_edges import MatchedEdges
from sonar_tracking.graph.orchestration.run_observer import RunObserver
from sonar_tracking.message_reading.field_reading import stamp_from_time

_OBSERVER_DEPTH = 10_000


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

    Attributes
    ----------
    notices : dict of str to str
        The latest sentence of every status that is, or was, not in order.
    errors : dict of str to str
        The same of errors of the nodes themselves.
    """

    def __init__(
        self,
        ledger: FlowLedger,
        matched: MatchedEdges,
        observer: RunObserver,
        nodes: Collection[str],
        sources: tuple[str, ...] = (),
        naming: GraphNames = ROOT_NAMES,
    ) -> None:
        self._ledger = ledger
        self._matched = matched
        self._observer = observer
        # Diagnostics call a node by its full name, without the slash before it.
        self._nodes = {naming.of_node(name).removeprefix("/"): name for name in nodes}
        self._observed: dict[str, int] = {}
        self._publishers: dict[str, Publisher] = {}
        self._served: dict[str, int | None] = dict.fromkeys(sources)
        self.notices: dict[str, str] = {}
        self.errors: dict[str, str] = {}
        self._context = Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = Node(
            CONTROL_NODE,
            context=self._context,
            namespace=naming.namespace,
            use_global_arguments=False,
        )
        self._clock = self._node.create_publisher(Clock, naming.clock, quality_of_service.CLOCK)
        self._node.create_subscription(
            Progress, naming.of(PROGRESS_TOPIC), self._progress, quality_of_service.PROGRESS
        )
        self._node.create_subscription(
            DiagnosticArray, DIAGNOSTICS_TOPIC, self._diagnostics, quality_of_service.DIAGNOSTICS
        )
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._node)

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

    def offer(self, topic: Topic, depth: int) -> None:
        """Become the publisher of a data topic."""
        name = resolved(topic)
        self._publishers[name] = self._node.create_publisher(
            message_class(topic.message_type),
            name,
            quality_of_service.publisher_profile(topic.kind, depth),
        )

    def publish_clock(self, stamp: int) -> None:
        """Tell the graph the time, ns."""
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
        if len(self.publishers_of(self._clock.topic_name)) > 1:
            topics.add(self._clock.topic_name)
        return [f"{topic} by {', '.join(self.publishers_of(topic))}" for topic in sorted(topics)]

    def publishers_of(self, topic: str) -> list[str]:
        """Return the full names of the nodes that publish a topic."""
        publishers = self._node.get_publishers_info_by_topic(topic)
        return sorted(f"{p.node_namespace.rstrip('/')}/{p.node_name}" for p in publishers)

    def matched_subscriptions(self, topic: str) -> int:
        """Return how many subscriptions a topic offered before is matched with."""
        return self._publishers[topic].get_subscription_count()

    def spin_once(self, patience: float) -> None:
        """Handle one event, waiting for it at most ``patience`` seconds."""
        self._executor.spin_once(timeout_sec=patience)

    def _observe(self, topic: str, data: bytes) -> None:
        wall = time.monotonic()
        self._observed[topic] += 1
        self._observer.observed(topic, data, wall)
        self._ledger.finished(CONTROL_NODE, topic, self._observed[topic])

    def _progress(self, message: Any) -> None:
        wall = time.monotonic()
        stamp = stamp_from_time(message.header.stamp)
        if message.topic == CLOCK_TOPIC:
            if message.node in self._served:
                self._served[message.node] = stamp
                self._ledger.changes += 1
        elif self._ledger.producer(message.topic) == message.node:
            self._ledger.published(message.node, message.topic, message.count)
            self._observer.announced(message.topic, stamp, wall)
        else:
            self._ledger.finished(message.node, message.topic, message.count)

    def _diagnostics(self, message: Any) -> None:
        for status in message.status:
            full_name, _, concern = status.name.partition(": ")
            node = self._nodes.get(full_name)
            if node is None:
                continue
            if concern == MATCHED:
                self._matched.report(node, {item.key: int(item.value) for item in status.values})
            elif status.level != DiagnosticStatus.OK:
                told = self.errors if concern == UNEXPECTED else self.notices
                told[status.name] = f"{node}: {status.message}"
