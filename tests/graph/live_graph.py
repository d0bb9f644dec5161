"""Real nodes as processes, and a probe in the test that talks to them over real topics."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.graph.catalogue.topics import (
    CLOCK_TOPIC,
    DIAGNOSTICS_TOPIC,
    PROGRESS_TOPIC,
    Topic,
    TopicKind,
)
from sonar_tracking.graph.catalogue.transport_profile import choose_transport
from sonar_tracking.graph.message_writing.field_writing import message_class, time_from_stamp
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.message_reading.field_reading import stamp_from_time
from tests.left_open import closed, opened
from tests.process_source import CopiedProcess
from tests.ros_domain import ros_domain

PATIENCE = 40.0
"""Longest wait for anything, s: generous, because machines may be busy."""

DEPTH = 100

# Nodes and probe find each other at once, as those of a run do.
os.environ.update(choose_transport(0, 0).others)


class NodeProcess:
    """One node as a process of its own.

    Parameters
    ----------
    module : str
        E.g. ``"sonar_tracking.graph.nodes.subspace_estimator"``.
    log : Path
        Where its output goes.
    namespace : str
        Of its node and topics.
    parameters : dict
        ROS parameters, as on the command line.
    """

    def __init__(
        self, module: str, log: Path, namespace: object = "/", **parameters: object
    ) -> None:
        arguments = ["--ros-args", "-r", f"__ns:={namespace}"]
        for name, value in parameters.items():
            arguments += ["-p", f"{name}:={value}"]
        self._log = log
        environment = {**os.environ, "ROS_DOMAIN_ID": str(ros_domain())}
        self._process = CopiedProcess(module, arguments, environment, log)

    @property
    def output(self) -> str:
        """Everything it has written so far."""
        return self._log.read_text()

    @property
    def is_alive(self) -> bool:
        """Whether it still runs."""
        return self._process.poll() is None

    def send_signal(self, number: int) -> None:
        """Send a signal."""
        self._process.send_signal(number)

    def stop(self, number: int = signal.SIGTERM) -> int:
        """Send a signal and return the exit code."""
        self.send_signal(number)
        return self._process.wait(PATIENCE)

    def wait(self) -> int:
        """Return the exit code of a process that ends by itself."""
        return self._process.wait(PATIENCE)

    def kill(self) -> None:
        """End it whatever it does."""
        self._process.kill()
        self._process.wait(PATIENCE)

    def end(self) -> None:
        """End it in order, so that it gives back the memory it shares, or else with force.

        One that is killed leaves behind a port to which all participants of the machine listen, in
        whatever domain. It is then made anew, and Fast DDS fails with a segmentation fault in a
        process, like that of the tests, that closes a participant at that moment.
        """
        try:
            self.stop()
        except subprocess.TimeoutExpired:
            self.kill()


@contextmanager
def node_process(
    module: str, log: Path, namespace: object = "/", **parameters: object
) -> Iterator[NodeProcess]:
    """Run a node for the length of a block."""
    process = NodeProcess(module, log, namespace, **parameters)
    try:
        yield process
    finally:
        process.end()


class Probe:
    """A node in the test: publishes clock and data, remembers what it hears."""

    def __init__(self, name: str = "probe") -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=ros_domain())
        self.node = Node(name, context=self._context, use_global_arguments=False)
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._clock = self.node.create_publisher(Clock, CLOCK_TOPIC, quality_of_service.CLOCK)
        self._publishers: dict[str, Any] = {CLOCK_TOPIC: self._clock}
        self.diagnostics: list[DiagnosticArray] = []
        self.progress: list[Progress] = []
        self.node.create_subscription(
            DiagnosticArray,
            DIAGNOSTICS_TOPIC,
            self.diagnostics.append,
            quality_of_service.DIAGNOSTICS,
        )
        self.node.create_subscription(
            Progress, PROGRESS_TOPIC, self.progress.append, quality_of_service.PROGRESS
        )
        opened(self.close)

    def close(self) -> None:
        """Leave the graph."""
        closed(self.close)
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def listen(self, topic: Topic) -> list[Any]:
        """Return a list that grows with the messages of a topic."""
        heard: list[Any] = []
        self.node.create_subscription(
            message_class(topic.message_type),
            topic.name,
            heard.append,
            quality_of_service.subscription_profile(DEPTH),
        )
        return heard

    def publisher(self, topic: Topic) -> Any:
        """Return a publisher of a data topic."""
        publisher = self.node.create_publisher(
            message_class(topic.message_type),
            topic.name,
            quality_of_service.publisher_profile(TopicKind.DATA, DEPTH),
        )
        self._publishers[publisher.topic_name] = publisher
        return publisher

    def tick(self, stamp: int) -> None:
        """Publish ``/clock``."""
        self._clock.publish(Clock(clock=time_from_stamp(stamp)))

    def wait(self, condition: Callable[[], object], what: str | Callable[[], str]) -> None:
        """Handle events until a condition holds; what has not come is told as it is at the end."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > deadline:
                told = what if isinstance(what, str) else what()
                raise AssertionError(f"not within {PATIENCE:g} s: {told}")
            self._executor.spin_once(timeout_sec=0.05)

    def wait_for_count(self, count: Callable[[], int], least: int, what: str) -> None:
        """Handle events until a count has reached a number."""
        self.wait(lambda: count() >= least, lambda: f"{least} {what}, there are {count()}")

    def wait_matched(self, node: str, *topics: str) -> None:
        """Wait until a node reports at least one remote endpoint on each of the topics."""
        self.wait(
            lambda: all(int(self.matched(node).get(topic, 0)) > 0 for topic in topics),
            f"{node} matched on {', '.join(topics)}",
        )
        for topic in set(topics) & set(self._publishers):
            # Who is matched there is not yet known here: what is sent before that is lost.
            count = self._publishers[topic].get_subscription_count
            self.wait(count, f"{node} to be heard of as a reader of {topic}")

    def matched(self, node: str) -> dict[str, str]:
        """Return the newest report of a node on its connections."""
        return self.values(f"{node}: matched")

    def values(self, status: str) -> dict[str, str]:
        """Return the newest numbers of a status."""
        for message in reversed(self.diagnostics):
            for each in message.status:
                if each.name == status:
                    return {value.key: value.value for value in each.values}
        return {}

    def sentences(self, status: str) -> list[str]:
        """Return every sentence of a status heard so far, oldest first."""
        return [s.message for m in self.diagnostics for s in m.status if s.name == status]

    def wait_sentence(self, status: str, *parts: str) -> None:
        """Wait for a status with a sentence that contains all the parts."""
        self.wait(
            lambda: any(all(p in text for p in parts) for text in self.sentences(status)),
            lambda: f"{status} with {' ... '.join(parts)}; heard {self.sentences(status)[-1:]}",
        )

    def finished(self, node: str, topic: str) -> int:
        """Return how many messages of a topic a node has reported."""
        counts = [p.count for p in self.progress if p.node == node and p.topic == topic]
        return max(counts, default=0)


def stamps(messages: list[Any]) -> list[int]:
    """Return the stamps of messages, ns."""
    return [stamp_from_time(message.header.stamp) for message in messages]
