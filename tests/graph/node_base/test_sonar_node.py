"""The shell around a stage: joins its inputs, and survives whatever the stage does."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions

from sonar_tracking.errors import InputError, Notice, Severity
from sonar_tracking.graph.catalogue.node_configuration import NodeConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, ODOMETRY, TRUE_BEARING_TRACKS
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.graph.node_base.data_flow import Received
from sonar_tracking.graph.node_base.diagnostics import UNEXPECTED
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading import array_reading
from sonar_tracking.own_ship_interpolation import interpolate_own_ship
from sonar_tracking.records.own_ship import OwnShipState
from tests.graph.live_graph import Probe
from tests.ros_domain import ros_domain

pytestmark = pytest.mark.graph

SECOND = 1_000_000_000
START = 1_767_225_600 * SECOND
NODE = NodeDescription(
    name="example",
    module="",
    description="joins tracks with own ship",
    configurations=(NodeConfiguration,),
    inputs=(BEARING_TRACKS, ODOMETRY),
    outputs=(TRUE_BEARING_TRACKS,),
)
INPUT = "example: input /passive/bearing_tracks"


class Example(SonarNode):
    """Republishes tracks, fails when told to."""

    def __init__(self) -> None:
        super().__init__(NODE)
        self.failure: Exception | None = None
        self.own_ship: list[OwnShipState | None] = []
        self.substituted: list[int] = []
        self.output = self.data_publisher(TRUE_BEARING_TRACKS)
        self.data_subscriptions(
            {BEARING_TRACKS: array_reading.bearing_tracks_from_message},
            series={ODOMETRY: (array_reading.own_ship_from_message, interpolate_own_ship)},
        )

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        if self.failure is not None:
            raise self.failure
        self.own_ship.append(item.series[ODOMETRY.name])
        self.output.publish(array_writing.bearing_tracks_to_message(records[BEARING_TRACKS.name]))
        return [Notice(Severity.WARN, "weather", "It rains; wear a hat.")]

    def substitute(self, rejected: Received) -> None:
        self.substituted.append(rejected.stamp)


class Live:
    """The node, the probe and what feeds the node."""

    def __init__(self) -> None:
        rclpy.init(
            args=[],
            domain_id=ros_domain(),
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self.node = Example()
        self._executor = EventsExecutor()
        self._executor.add_node(self.node)
        self.probe = Probe()
        self._tracks = self.probe.publisher(BEARING_TRACKS)
        self._odometry = self.probe.publisher(ODOMETRY)
        self.outputs = self.probe.listen(TRUE_BEARING_TRACKS)
        self.wait(
            lambda: all(
                int(self.probe.matched("example").get(name, 0))
                for name in ("/passive/bearing_tracks", "/own_ship/odometry", "/flow/done")
            )
        )
        self.wait(
            lambda: (
                self._tracks.get_subscription_count() and self._odometry.get_subscription_count()
            )
        )

    def wait(self, condition: Any) -> None:
        """Let node and probe work until a condition holds."""

        def worked() -> object:
            self._executor.spin_once(timeout_sec=0.01)
            return condition()

        self.probe.wait(worked, "condition")

    def send_tracks(self, stamp: int) -> None:
        """Publish an empty picture."""
        tracks = dataclasses.replace(array_writing.NO_BEARING_TRACKS, stamp=stamp)
        self._tracks.publish(array_writing.bearing_tracks_to_message(tracks))

    def send_odometry(self, stamp: int, x: float) -> None:
        """Publish own ship at x."""
        state = OwnShipState(stamp, (x, 0.0), 0.0, (0.0, 0.0), 0.0)
        self._odometry.publish(array_writing.own_ship_to_message(state))

    def finished(self, topic: str) -> int:
        """Return how many messages of a topic the node has reported."""
        return self.probe.finished("example", topic)

    def announced(self, topic: str) -> list[int]:
        """Return the numbers of messages of a topic the node has told to have published."""
        return [each.count for each in self.probe.progress if each.topic == topic]

    def close(self) -> None:
        """Leave the graph."""
        self.probe.close()
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown()


@pytest.fixture
def live() -> Iterator[Live]:
    live = Live()
    yield live
    live.close()


def test_a_node_joins_reports_and_survives(live: Live) -> None:
    """One story, since a graph takes time to meet: join, notice, failure, recovery."""
    live.send_odometry(START, 0.0)
    live.send_tracks(START + SECOND)
    live.wait(lambda: live.finished("/own_ship/odometry") == 1)
    assert live.node.own_ship == [], "no odometry at or after the tracks yet"
    live.send_odometry(START + 4 * SECOND, 8.0)
    live.wait(lambda: live.finished("/passive/bearing_tracks") == 1 and live.outputs)
    (own_ship,) = live.node.own_ship
    assert own_ship is not None
    np.testing.assert_allclose(own_ship.position, (2.0, 0.0))
    live.wait(lambda: live.probe.sentences("example: weather"))
    assert live.probe.sentences("example: weather")[-1] == "It rains; wear a hat."

    live.node.failure = ZeroDivisionError("division by zero")
    live.send_tracks(START + 2 * SECOND)
    live.wait(lambda: live.finished("/passive/bearing_tracks") == 2)
    live.wait(lambda: live.probe.sentences(f"example: {UNEXPECTED}"))
    assert (
        "ZeroDivisionError: division by zero" in live.probe.sentences(f"example: {UNEXPECTED}")[-1]
    )

    live.node.failure = InputError("The tracks are upside down; turn them.")
    live.send_tracks(START + 3 * SECOND)
    live.wait(lambda: live.finished("/passive/bearing_tracks") == 3)
    live.wait(lambda: "upside down; turn them" in live.probe.sentences(INPUT)[-1])
    assert live.node.substituted == [START + 2 * SECOND, START + 3 * SECOND]

    live.node.failure = None
    live.send_tracks(START + 4 * SECOND)
    live.wait(lambda: len(live.outputs) == 2)
    live.wait(lambda: live.announced("/truth/bearing_tracks")[-1:] == [2])
    assert live.announced("/truth/bearing_tracks") in ([1, 2], [2])
