"""Node ``contact_simulator``: the contacts of a scenario's active sonar, ping by ping."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from sonar_tracking.graph.catalogue.simulator_nodes import CONTACT_SIMULATOR
from sonar_tracking.graph.catalogue.topics import CONTACTS
from sonar_tracking.graph.message_writing.contact_writing import contacts_to_message
from sonar_tracking.graph.node_base.data_flow import DataOutput
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sensor_simulator_node import SensorSimulatorNode
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.active_sonar_simulation import (
    ActiveSonarSimulation,
    ReceivedPing,
)


class ContactSimulator(SensorSimulatorNode):
    """Publishes the pings of an :class:`ActiveSonarSimulation` when they are due.

    A ping is due when its last echo has been received.
    """

    def __init__(self) -> None:
        super().__init__(CONTACT_SIMULATOR)
        self._contacts = self.data_publisher(CONTACTS)
        self.begin()

    @property
    def main_output(self) -> DataOutput:
        """Publisher of the contacts."""
        return self._contacts

    def data(self, scenario: Scenario) -> Iterator[ReceivedPing]:
        """Return the pings of a scenario."""
        return iter(ActiveSonarSimulation(scenario))

    def publish(self, datum: ReceivedPing) -> None:
        """Publish a ping."""
        self._contacts.publish(contacts_to_message(datum.contacts))


def main() -> int:
    """Run the node."""
    return run_node(ContactSimulator)


if __name__ == "__main__":
    sys.exit(main())
