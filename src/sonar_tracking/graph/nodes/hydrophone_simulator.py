"""Node ``hydrophone_simulator``: element time series, and the true angles, block by block."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from sonar_tracking.graph.catalogue.simulator_nodes import HYDROPHONE_SIMULATOR
from sonar_tracking.graph.catalogue.topics import (
    SAMPLES,
    TRUE_BEARING_TRACKS,
)
from sonar_tracking.graph.message_writing.sample_writing import samples_to_message
from sonar_tracking.graph.message_writing.simulated_writing import (
    bearing_tracks_to_bytes,
)
from sonar_tracking.graph.node_base.data_flow import DataOutput
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sensor_simulator_node import SensorSimulatorNode
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.sample_simulation import SampleSimulation
from sonar_tracking.simulation.sensors.simulated_data import SimulatedSamples


class HydrophoneSimulator(SensorSimulatorNode):
    """Publishes the blocks of a :class:`SampleSimulation` when they are due.

    A block is due when its last sample lies in the past.
    """

    def __init__(self) -> None:
        super().__init__(HYDROPHONE_SIMULATOR)
        self._samples = self.data_publisher(SAMPLES)
        self._true_bearings = self.data_publisher(TRUE_BEARING_TRACKS)
        self.begin()

    @property
    def main_output(self) -> DataOutput:
        """Publisher of the samples."""
        return self._samples

    def data(self, scenario: Scenario) -> Iterator[SimulatedSamples]:
        """Return the blocks of a scenario."""
        return iter(SampleSimulation(scenario).next_block, None)

    def publish(self, datum: SimulatedSamples) -> None:
        """Publish a block: the true angles ahead of the data."""
        self._true_bearings.publish(bearing_tracks_to_bytes(datum.truth_bearings))
        self._samples.publish(samples_to_message(datum.samples))


def main() -> int:
    """Run the node."""
    return run_node(HydrophoneSimulator)


if __name__ == "__main__":
    sys.exit(main())
