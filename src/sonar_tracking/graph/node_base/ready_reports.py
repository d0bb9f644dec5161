"""What a node says of its neighbours: whom it has found, as soon as it has.

Whoever starts the graph, or a node of it again, waits for these reports, so they come with every
new connection. Once a node is connected it has time until the first data: what takes long at its
first use is done then. With the first data, which come once all have found all, and while they flow
nothing is looked up until the number of connections changes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from sonar_tracking.graph.catalogue.topics import DIAGNOSTICS_TOPIC
from sonar_tracking.graph.node_base.diagnostics import NEIGHBOURS, Diagnostics
from sonar_tracking.graph.node_base.neighbours import Neighbours

LOOK_PERIOD = 0.05
"""Between looks at the connections, s of steady time."""

LOOKS_PER_REPORT = 4
"""So many looks later a report is repeated, if nothing has changed."""

EAGER_LOOKS = 10
"""After so many looks only every few of them asks who is there, where data flow."""

PATIENCE_LOOKS = 100
"""After so many looks a node no longer waits for connections that may never come, nor for the
name of a neighbour."""


class ReadyReports:
    """Publishes the state of a node whenever its connections change.

    Parameters
    ----------
    node : Node
        The node.
    diagnostics : Diagnostics
        Where its state is told.
    connections : callable
        Returns the number of matched remote endpoints by topic.
    data_flow : callable
        Tells whether the first message has been received or published.
    warm_up : callable
        Called once, when every topic is connected, or is not after a while.
    """

    def __init__(
        self,
        node: Node,
        diagnostics: Diagnostics,
        connections: Callable[[], Mapping[str, object]],
        data_flow: Callable[[], bool],
        warm_up: Callable[[], None] = lambda: None,
    ) -> None:
        self._node = node
        self._diagnostics = diagnostics
        self._connections = connections
        self._data_flow = data_flow
        self._warm_up = warm_up
        self._warm = False
        self._looks = 0
        self._quiet = self._flowed = False
        self._told: dict[str, object] = {}
        self._neighbours = Neighbours(node)
        diagnostics.add(NEIGHBOURS, self._neighbours.values)
        node.create_timer(LOOK_PERIOD, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _look(self) -> None:
        connections = {**self._connections(), DIAGNOSTICS_TOPIC: self._listeners()}
        changed = connections != self._told
        self._told = connections
        flows = self._data_flow()
        if flows and not self._flowed:
            self._flowed = self._quiet = True
        if changed:
            self._looks = 0 if flows else self._looks
            self._quiet = False
        if self._quiet:
            return
        if flows and not changed and self._looks > EAGER_LOOKS and self._looks % LOOKS_PER_REPORT:
            self._looks += 1
            return
        changed |= self._neighbours.look(name for name in connections if name != DIAGNOSTICS_TOPIC)
        if changed or self._looks % LOOKS_PER_REPORT == 0:
            self._diagnostics.publish()
        self._looks += 1
        patient = self._looks <= PATIENCE_LOOKS
        self._quiet = flows and not patient
        if not self._warm and not flows and (all(connections.values()) or not patient):
            self._warm = True
            with suppress(Exception):  # what goes wrong is told of the data, not of a rehearsal
                self._warm_up()

    def _listeners(self) -> int:
        """Return how many hear what this node says of itself."""
        reports = [p for p in self._node.publishers if p.topic_name == DIAGNOSTICS_TOPIC]
        return sum(publisher.get_subscription_count() for publisher in reports)
