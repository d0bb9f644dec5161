"""What a node reports on ``flow/done``: announcements and finished messages, several in one.

Counts add up, so that a report stands for all before it, and each costs as much as a block of data:
what nobody waits for is kept for a moment. The time master waits once a consumer is a flow window
of messages behind; a report comes after half of them, or after a moment. What a node has published
is always told before the input it was made from.
"""

from __future__ import annotations

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.graph.catalogue.flow_window import own_flow_window
from sonar_tracking.graph.catalogue.run_identity import signed
from sonar_tracking.graph.catalogue.topics import PROGRESS_TOPIC
from sonar_tracking.graph.message_writing.progress_writing import ProgressWriter
from sonar_tracking.graph.node_base import quality_of_service

WAIT_PER_BLOCK = 0.00125
"""Until what was finished is told, s of steady time for each block of the flow window."""


class ProgressReporter:
    """Publishes Progress messages of one node on ``flow/done``."""

    def __init__(self, node: Node) -> None:
        self._node_name = signed(node.get_name())
        window = own_flow_window()
        self._messages_per_report = window // 2
        self.publisher = node.create_publisher(
            Progress, PROGRESS_TOPIC, quality_of_service.PROGRESS
        )
        self._writers: dict[str, ProgressWriter] = {}
        self._announced: dict[str, tuple[int, int]] = {}
        self._finished: dict[str, tuple[int, int]] = {}
        self._told: dict[str, int] = {}
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._timer = node.create_timer(WAIT_PER_BLOCK * window, self._tell_rest, clock=steady)
        self._timer.cancel()
        self._runs = False

    def announce(self, topic: str, count: int, stamp: int) -> None:
        """Take the number of messages of a topic published; it is told with what comes next."""
        self._announced[topic] = (count, stamp)
        self._set_timer()

    def finish(self, topic: str, count: int, stamp: int) -> None:
        """Take the number of messages of a topic finished, and the stamp of the last, ns."""
        if count - self._told.get(topic, 0) >= self._messages_per_report:
            self._finished.pop(topic, None)
            self.report(topic, count, stamp)
            return
        self._finished[topic] = (count, stamp)
        self._set_timer()

    def report(self, topic: str, count: int, stamp: int) -> None:
        """Tell the number of messages of a topic finished now, after what was published."""
        announced, self._announced = self._announced, {}
        for each, known in announced.items():
            self._publish(each, *known)
        self._publish(topic, count, stamp)

    def announce_now(self, topic: str, count: int, stamp: int) -> None:
        """Tell the number of messages of a topic published now; other topics may wait."""
        self._publish(topic, count, stamp)

    def _tell_rest(self) -> None:
        """Tell what waits; without, sleep until something does."""
        rest = {**self._announced, **self._finished}
        self._announced, self._finished = {}, {}
        for topic, known in rest.items():
            self._publish(topic, *known)
        if not rest:
            self._timer.cancel()
            self._runs = False

    def _set_timer(self) -> None:
        if not self._runs:
            self._runs = True
            self._timer.reset()

    def _publish(self, topic: str, count: int, stamp: int) -> None:
        self._told[topic] = count
        writer = self._writers.get(topic)
        if writer is None:
            writer = self._writers[topic] = ProgressWriter(self._node_name, topic)
        self.publisher.publish(writer.message(count, stamp))
