"""Node ``world_simulator``: own ship and the truth of a scenario, for whatever sensors it has."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from sonar_tracking.graph.catalogue.simulator_nodes import SENSOR_SIMULATORS, WORLD_SIMULATOR
from sonar_tracking.graph.catalogue.topics import ODOMETRY, TRUE_TRACKS
from sonar_tracking.graph.message_writing.simulated_writing import (
    own_ship_to_bytes,
    truth_tracks_to_bytes,
)
from sonar_tracking.graph.node_base.data_flow import DataOutput
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.scenario_begin import BeginTeller
from sonar_tracking.graph.node_base.simulator_node import SimulatorNode
from sonar_tracking.simulation.scenarios.platforms import CONSORT
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.world.world_simulation import WorldInstant, WorldSimulation


class WorldSimulator(SimulatorNode):
    """Publishes the instants of a :class:`WorldSimulation` when they are there.

    Without simulation time it also decides when the scenario begins, for the sensors as well: when
    somebody listens to any of them.
    """

    def __init__(self) -> None:
        super().__init__(WORLD_SIMULATOR)
        self._true_tracks = self.data_publisher(TRUE_TRACKS)
        self._odometry = self.data_publisher(ODOMETRY)
        self._consort: DataOutput | None = None
        self._teller: BeginTeller | None = None
        self.begin()

    def data(self, scenario: Scenario) -> Iterator[WorldInstant]:
        """Return the instants of a scenario."""
        if scenario.consort is not None and self._consort is None:
            self._consort = self.data_publisher(ODOMETRY.below(CONSORT))
        return iter(WorldSimulation(scenario).next_instant, None)

    def publish(self, datum: WorldInstant) -> None:
        """Publish an instant: the ships ahead of the truth."""
        if datum.own_ship is not None:
            self._odometry.publish(own_ship_to_bytes(datum.own_ship))
        if datum.consort is not None and self._consort is not None:
            self._consort.publish(own_ship_to_bytes(datum.consort))
        if datum.truth_tracks is not None:
            self._true_tracks.publish(truth_tracks_to_bytes(datum.truth_tracks))

    def began(self, scenario: Scenario, now: int) -> int | None:
        """Return when the scenario has begun, ns; None = nobody listens yet."""
        if self._teller is None:
            self._teller = BeginTeller(self, _heard_topics(scenario))
        return self._teller.told(now)


def _heard_topics(scenario: Scenario) -> list[str]:
    """Return the topics whose listeners make a scenario begin: the data, and those of this node."""
    stations = ("", *(station.namespace for station in scenario.stations))
    sensors = [
        node.at_station(station)
        for station in stations
        for node in SENSOR_SIMULATORS
        if node.section in scenario.simulated_in(station)
    ]
    nodes = (WORLD_SIMULATOR, *sensors)
    return [topic.name for node in nodes for topic in node.published(scenario.namespaces)]


def main() -> int:
    """Run the node."""
    return run_node(WorldSimulator)


if __name__ == "__main__":
    sys.exit(main())
