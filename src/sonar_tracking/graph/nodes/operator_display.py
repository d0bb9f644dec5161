"""Node ``operator_display``: serves the live page to browsers.

Inputs: whatever the page can show, of the topics given by the parameters or of all below its
namespace. It listens like any visitor: nobody waits for it, it reports no progress, and it may die
and return. Messages wait in a bounded queue for the thread of the web server; what that cannot keep
up with is counted, said, and left out.
"""

from __future__ import annotations

import sys
import threading
import time
from collections import deque
from collections.abc import Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.display.page.page_address import page_token
from sonar_tracking.display.page.page_commands import command_from_page
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.shown_types import KEPT_TYPES, SHOWN_TYPES
from sonar_tracking.display.page.web_browser import open_browser
from sonar_tracking.errors import ConfigurationError, InputError, Severity
from sonar_tracking.graph.catalogue.command_kinds import check_command
from sonar_tracking.graph.catalogue.page_nodes import OPERATOR_DISPLAY
from sonar_tracking.graph.catalogue.topics import DIAGNOSTICS
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import parameters, quality_of_service
from sonar_tracking.graph.node_base.command_sender import CommandSender
from sonar_tracking.graph.node_base.datum_topic import listen_to_datum
from sonar_tracking.graph.node_base.diagnostics import MATCHED, Diagnostics
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.node_watch import STATUS_PERIOD
from sonar_tracking.graph.node_base.ready_reports import ReadyReports
from sonar_tracking.records.time import nanoseconds

PAGE = "page"
"""Concern: where the page is, and how many look at it."""

DEPTH = 100
"""Messages kept per topic."""

LONGEST_QUEUE = 5000
LARGEST_QUEUE = 64 * 1024 * 1024
"""Messages, and bytes, that may wait for the thread of the server."""

LONGEST_TURN = 0.05
"""For which new messages keep the server from its browsers, s of the wall clock."""

BACKWARDS = nanoseconds(30.0)
"""Stamps that are earlier than the newest by more tell that the clock has gone back, ns."""

LOOK_PERIOD = 0.5
"""Between two looks for new topics, s of steady time."""


class OperatorDisplay(Node):
    """Shell around :class:`sonar_tracking.display.page.page_server.PageServer`."""

    def __init__(self) -> None:
        super().__init__(OPERATOR_DISPLAY.name)
        given = parameters.overrides_of(self)
        parameters.check_overrides(OPERATOR_DISPLAY.configurations, given, self.get_name())
        configuration = parameters.resolve(PageConfiguration, given, self.get_name())
        parameters.declare(self, configuration)
        if len(configuration.topics) != len(configuration.types):
            raise ConfigurationError(
                f"{self.get_name()}: there are {len(configuration.topics)} topics and "
                f"{len(configuration.types)} types; give the type of each topic."
            )
        reports = self.create_publisher(
            DiagnosticArray, DIAGNOSTICS.name, quality_of_service.DIAGNOSTICS
        )
        name = self.get_fully_qualified_name().lstrip("/")
        self._diagnostics = Diagnostics(name, self.get_logger(), reports.publish)
        self._waiting: deque[tuple[str, type, bytes]] = deque()
        self._waiting_bytes = 0
        self._lock = threading.Lock()
        self._missed = 0
        self._heard: dict[str, Any] = {}
        self._received = False
        self._newest = 0
        self._sender = CommandSender(self)
        namespace = self.get_namespace().rstrip("/")
        self._server = PageServer(configuration, page_token(), self._command, namespace=namespace)
        self._server.start()
        self.get_logger().info(f"the page is at {self._server.address}")
        for topic, type_name in zip(configuration.topics, configuration.types, strict=True):
            self._listen(topic, type_name, type_name in KEPT_TYPES)
        self._listen(DIAGNOSTICS.name, DIAGNOSTICS.message_type, kept=False)
        if not configuration.datum:
            feed = self._server.feed
            listen_to_datum(self, lambda datum: self._server.do(lambda: feed.take_datum(datum)))
        self._diagnostics.add(MATCHED, self._matched)
        self._diagnostics.add(PAGE, self._page)
        ReadyReports(self, self._diagnostics, self._matched, lambda: self._received)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(STATUS_PERIOD, self._report, clock=steady)
        if not configuration.topics:
            self.create_timer(LOOK_PERIOD, self._look_for_topics, clock=steady)
        if configuration.open_browser:
            open_browser(self._server.address)

    def destroy_node(self) -> None:
        """Close the page and release the node."""
        self._server.stop()
        super().destroy_node()

    def _look_for_topics(self) -> None:
        """Listen to every topic below the own namespace that can be shown."""
        below = self.get_namespace().rstrip("/") + "/"
        for topic, types in self.get_topic_names_and_types():
            if topic not in self._heard and topic.startswith(below):
                offered = [each.qos_profile for each in self.get_publishers_info_by_topic(topic)]
                if not offered:
                    continue
                kept = all(one.durability == DurabilityPolicy.TRANSIENT_LOCAL for one in offered)
                for type_name in set(types) & set(SHOWN_TYPES):
                    self._listen(topic, type_name, kept)

    def _listen(self, topic: str, type_name: str, kept: bool) -> None:
        """Listen to a topic; ``kept`` = what was said before is wanted, and publishers have it."""
        kind = message_class(type_name)
        self._server.do(lambda: self._server.feed.expect(topic, type_name))

        def receive(data: bytes) -> None:
            self._receive(topic, kind, data)

        profile = QoSProfile(
            history=HistoryPolicy.KEEP_LAST,
            depth=DEPTH,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
        )
        self._heard[topic] = self.create_subscription(kind, topic, receive, profile, raw=True)

    def _receive(self, topic: str, kind: type, data: bytes) -> None:
        if kind is not DiagnosticArray:
            self._received = True
            stamp = head_stamp(data)
            back = stamp < self._newest - BACKWARDS
            self._newest = stamp if back else max(self._newest, stamp)
            self._diagnostics.advance(self._newest)
        with self._lock:
            full = len(self._waiting) >= LONGEST_QUEUE or self._waiting_bytes > LARGEST_QUEUE
            if full:
                self._missed += 1
                return
            begins = not self._waiting
            self._waiting.append((topic, kind, data))
            self._waiting_bytes += len(data)
        if begins:
            self._server.do(self._show)

    def _show(self) -> None:
        """Show some of what waits; called by the thread of the server, which has browsers, too."""
        is_all = False
        try:
            is_all = self._show_some(time.monotonic() + LONGEST_TURN)
        finally:
            if not is_all:
                self._server.do(self._show)

    def _show_some(self, end: float) -> bool:
        """Show what waits, until a time; return whether nothing waits any more.

        What is being shown waits, too: until it is shown nobody calls a second time for it.
        """
        feed = self._server.feed
        feed.health.missed = self._missed
        while time.monotonic() < end:
            with self._lock:
                if not self._waiting:
                    return True
                topic, kind, data = self._waiting[0]
            try:
                feed.take(topic, deserialize_message(data, kind))
            finally:
                with self._lock:
                    self._waiting.popleft()
                    self._waiting_bytes -= len(data)
        return False

    def _command(self, fields: Mapping[str, Any]) -> tuple[bool, str]:
        """Ask for what an operator commands; called by the thread of the server."""
        try:
            command = command_from_page(fields)
            check_command(command)
            self._sender.send(command, self._newest)
        except InputError as error:
            return False, str(error)
        return True, f"{command.kind.name.lower().replace('_', ' ')}: sent."

    def _report(self) -> None:
        if self._missed:
            sentence = (
                f"{self._missed} messages came too fast for the page and are not shown; run with a "
                "lower --rate to see all."
            )
            self._diagnostics.report(PAGE, "missed", Severity.WARN, sentence)
        self._diagnostics.publish()

    def _page(self) -> dict[str, object]:
        return {
            "port": self._server.port,
            "browsers": len(self._server.clients),
            "refused commands": self._server.refused,
        }

    def _matched(self) -> dict[str, object]:
        return {topic: entry.get_publisher_count() for topic, entry in self._heard.items()}


def main() -> int:
    """Run the node."""
    return run_node(OperatorDisplay)


if __name__ == "__main__":
    sys.exit(main())
