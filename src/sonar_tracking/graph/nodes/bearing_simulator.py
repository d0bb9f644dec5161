"""Node ``bearing_simulator``: bearings and lines of all stations of a scenario, frame by frame."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from sonar_tracking.graph.catalogue.simulator_nodes import BEARING_SIMULATOR
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    FREQUENCY_LINES,
    TRUE_BEARING_TRACKS,
    Topic,
)
from sonar_tracking.graph.message_writing.line_writing import frequency_lines_to_message
from sonar_tracking.graph.message_writing.simulated_writing import (
    bearing_tracks_to_bytes,
)
from sonar_tracking.graph.node_base.data_flow import DataOutput
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sensor_simulator_node import SensorSimulatorNode
from sonar_tracking.simulation.scenarios.scenario import BEARING_SENSORS, Scenario
from sonar_tracking.simulation.sensors.bearing_simulation import (
    BearingSimulation,
    SimulatedFrame,
    StationReport,
)


class BearingSimulator(SensorSimulatorNode):
    """Publishes the frames of a :class:`BearingSimulation` when they are due.

    The topics of a station are in its namespace; they are made when the scenario is read.
    """

    def __init__(self) -> None:
        super().__init__(BEARING_SIMULATOR)
        self._stations: list[dict[Topic, DataOutput]] = []
        self.begin()

    @property
    def main_output(self) -> DataOutput:
        """Publisher of the bearings of the first station."""
        return self._stations[0][BEARING_TRACKS]

    def data(self, scenario: Scenario) -> Iterator[SimulatedFrame]:
        """Return the frames of a scenario."""
        simulation = BearingSimulation(scenario)
        if not self._stations:
            self._stations = [
                self._station(namespace) for namespace in scenario.namespaces[BEARING_SENSORS]
            ]
        return iter(simulation.next_frame, None)

    def publish(self, datum: SimulatedFrame) -> None:
        """Publish a frame: the true angles ahead of the data."""
        for report in datum.reports:
            self._publish_station(report)

    def _station(self, namespace: str) -> dict[Topic, DataOutput]:
        return {
            topic: self.data_publisher(topic.below(namespace))
            for topic in (BEARING_TRACKS, FREQUENCY_LINES, TRUE_BEARING_TRACKS)
        }

    def _publish_station(self, report: StationReport) -> None:
        outputs = self._stations[report.station]
        truth = bearing_tracks_to_bytes(report.truth)
        outputs[TRUE_BEARING_TRACKS].publish(truth)
        if report.bearings is not None and report.lines is not None:
            outputs[FREQUENCY_LINES].publish(frequency_lines_to_message(report.lines))
            bearings = bearing_tracks_to_bytes(report.bearings)
            outputs[BEARING_TRACKS].publish(bearings)


def main() -> int:
    """Run the node."""
    return run_node(BearingSimulator)


if __name__ == "__main__":
    sys.exit(main())
