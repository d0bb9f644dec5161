"""Node ``array_simulator``: the snapshots of a scenario's array, block by block."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from sonar_tracking.graph.catalogue.simulator_nodes import ARRAY_SIMULATOR
from sonar_tracking.graph.catalogue.topics import (
    SNAPSHOTS,
    TRUE_BEARING_TRACKS,
)
from sonar_tracking.graph.message_writing.simulated_writing import (
    bearing_tracks_to_bytes,
    snapshots_to_bytes,
)
from sonar_tracking.graph.node_base.data_flow import DataOutput
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sensor_simulator_node import SensorSimulatorNode
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation
from sonar_tracking.simulation.sensors.simulated_data import SimulatedBlock
from sonar_tracking.simulation.signals.near_targets import near_target_notices


class ArraySimulator(SensorSimulatorNode):
    """Publishes the blocks of an :class:`ArraySimulation` when they are due.

    A block is due when its last snapshot lies in the past.
    """

    def __init__(self) -> None:
        super().__init__(ARRAY_SIMULATOR)
        self._snapshots = self.data_publisher(SNAPSHOTS)
        self._true_bearings = self.data_publisher(TRUE_BEARING_TRACKS)
        self.begin()

    @property
    def main_output(self) -> DataOutput:
        """Publisher of the snapshots."""
        return self._snapshots

    def data(self, scenario: Scenario) -> Iterator[SimulatedBlock]:
        """Return the blocks of a scenario; tell what targets are too near for plane waves."""
        for notice in near_target_notices(scenario):
            self.report("plane waves", notice.culprit, notice.severity, notice.text)
        return iter(ArraySimulation(scenario).next_block, None)

    def publish(self, datum: SimulatedBlock) -> None:
        """Publish a block: the true angles ahead of the data."""
        self._true_bearings.publish(bearing_tracks_to_bytes(datum.truth_bearings))
        self._snapshots.publish(snapshots_to_bytes(datum.snapshots))


def main() -> int:
    """Run the node."""
    return run_node(ArraySimulator)


if __name__ == "__main__":
    sys.exit(main())
