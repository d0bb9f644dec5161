"""Node ``contact_simulator``: the contacts, own ship and truth of a scenario, ping by ping."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from sonar_tracking.graph.catalogue.simulator_nodes import CONTACT_SIMULATOR
from sonar_tracking.graph.catalogue.topics import CONTACTS, ODOMETRY, TRUE_TRACKS
from sonar_tracking.graph.message_writing.contact_writing import contacts_to_message
from sonar_tracking.graph.message_writing.simulated_writing import (
    own_ship_to_bytes,
    truth_tracks_to_bytes,
)
from sonar_tracking.graph.node_base.data_flow import DataOutput
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.simulator_node import SimulatorNode
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.active_sonar_simulation import (
    ActiveSonarSimulation,
    ReceivedPing,
)


class ContactSimulator(SimulatorNode):
    """Publishes the pings of an :class:`ActiveSonarSimulation` when they are due.

    A ping is due when its last echo has been received.
    """

    def __init__(self) -> None:
        super().__init__(CONTACT_SIMULATOR)
        self._contacts = self.data_publisher(CONTACTS)
        self._true_tracks = self.data_publisher(TRUE_TRACKS)
        self._odometry = self.data_publisher(ODOMETRY)
        self.begin()

    @property
    def main_output(self) -> DataOutput:
        """Publisher of the contacts."""
        return self._contacts

    def data(self, scenario: Scenario) -> Iterator[ReceivedPing]:
        """Return the pings of a scenario."""
        return iter(ActiveSonarSimulation(scenario))

    def publish(self, datum: ReceivedPing) -> None:
        """Publish a ping: own ship and truth ahead of the data."""
        for state in datum.own_ship:
            self._odometry.publish(own_ship_to_bytes(state))
        self._true_tracks.publish(truth_tracks_to_bytes(datum.truth_tracks))
        self._contacts.publish(contacts_to_message(datum.contacts))


def main() -> int:
    """Run the node."""
    return run_node(ContactSimulator)


if __name__ == "__main__":
    sys.exit(main())
