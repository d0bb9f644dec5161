"""Node ``array_simulator``: the snapshots, own ship and truth of a scenario, block by block.

With simulation time it emits, at each ``/clock``, everything due up to it, so that skipped ticks
do no harm, and reports on ``flow/done`` how far it has served the clock. Without, it paces itself
by the node's clock, from the moment somebody subscribes to the snapshots.
"""

from __future__ import annotations

import sys

import yaml
from rosgraph_msgs.msg import Clock

from sonar_tracking.errors import ConfigurationError, Severity
from sonar_tracking.graph import conversions, quality_of_service
from sonar_tracking.graph.diagnostics import PARAMETERS
from sonar_tracking.graph.node_catalogue import ARRAY_SIMULATOR
from sonar_tracking.graph.node_configuration import ArraySimulatorConfiguration
from sonar_tracking.graph.node_process import run_node
from sonar_tracking.graph.position_conversions import truth_tracks_to_message
from sonar_tracking.graph.sonar_node import SonarNode
from sonar_tracking.graph.topics import (
    CLOCK_TOPIC,
    ODOMETRY,
    SNAPSHOTS,
    TRUE_BEARING_TRACKS,
    TRUE_TRACKS,
)
from sonar_tracking.messages.fields import stamp_from_time
from sonar_tracking.simulation.array_simulation import ArraySimulation
from sonar_tracking.simulation.records import SimulatedBlock
from sonar_tracking.simulation.scenario import Scenario, load_scenario, scenario_from_mapping


class ArraySimulator(SonarNode):
    """Publishes the blocks of an :class:`ArraySimulation` when they are due.

    A block is due when its last snapshot lies in the past. A scenario that cannot be used is
    reported, and the node idles.
    """

    def __init__(self) -> None:
        super().__init__(ARRAY_SIMULATOR)
        configuration = self.configuration(ArraySimulatorConfiguration)
        self._snapshots = self.data_publisher(SNAPSHOTS)
        self._true_bearings = self.data_publisher(TRUE_BEARING_TRACKS)
        self._true_tracks = self.data_publisher(TRUE_TRACKS)
        self._odometry = self.data_publisher(ODOMETRY)
        self._ticks = 0
        self._simulation: ArraySimulation | None = None
        self._block: SimulatedBlock | None = None
        try:
            self._start(read_scenario(configuration.scenario))
        except ConfigurationError as error:
            sentence = f"{error} The simulator idles; start it again with another scenario."
            self.diagnostics.report(PARAMETERS, "scenario", Severity.ERROR, sentence, lasting=True)

    def serve(self, now: int) -> None:
        """Publish every block due up to a scenario stamp, ns."""
        while self._block is not None and _end_stamp(self._block) <= now:
            self._publish(self._block)
            self._next_block()

    def _start(self, scenario: Scenario) -> None:
        self._simulation = ArraySimulation(scenario)
        self._next_block()
        if self.get_parameter("use_sim_time").value:
            self.create_subscription(Clock, CLOCK_TOPIC, self._tick, quality_of_service.CLOCK)
            return
        self._start_stamp = scenario.stamp(scenario.start)
        self._started: int | None = None
        block_period = scenario.array.block_snapshots / scenario.array.snapshot_rate
        self.create_timer(block_period, self._pace)

    def _tick(self, clock: Clock) -> None:
        now = stamp_from_time(clock.clock)
        if self._ticks == 0:
            self._skip_past(now)
        self.serve(now)
        self._ticks += 1
        self.progress.report(CLOCK_TOPIC, self._ticks, clock.clock)

    def _pace(self) -> None:
        now = self.get_clock().now().nanoseconds
        if self._started is None:
            if self._snapshots.publisher.get_subscription_count() == 0:
                return
            self._started = now
        self.serve(self._start_stamp + now - self._started)

    def _skip_past(self, now: int) -> None:
        """Leave out what was published before this process was started (again).

        What may have been lost with the previous process is repeated: consumers ignore
        duplicates.
        """
        repeated = self.node_configuration.flow_depth // 2
        while self._block is not None:
            length = _end_stamp(self._block) - self._block.snapshots.stamp
            if _end_stamp(self._block) > now - repeated * length:
                return
            self._next_block()

    def _next_block(self) -> None:
        assert self._simulation is not None
        self._block = self._simulation.next_block()

    def _publish(self, block: SimulatedBlock) -> None:
        for state in block.own_ship:
            self._odometry.publish(conversions.own_ship_to_message(state))
        self._true_tracks.publish(truth_tracks_to_message(block.truth_tracks))
        self._true_bearings.publish(conversions.bearing_tracks_to_message(block.truth_bearings))
        self._snapshots.publish(conversions.snapshots_to_message(block.snapshots))
        self.diagnostics.advance(block.snapshots.stamp)


def read_scenario(value: str) -> Scenario:
    """Return the scenario a parameter names, or spells out as YAML text of several lines.

    Raises
    ------
    ConfigurationError
        When there is none of that name, or it is malformed.
    """
    if "\n" not in value:
        return load_scenario(value)
    try:
        mapping = yaml.safe_load(value)
    except yaml.YAMLError as error:
        raise ConfigurationError(f"The text of the scenario is not YAML: {error}.") from error
    if not isinstance(mapping, dict):
        raise ConfigurationError("The text of the scenario must be a mapping of names to values.")
    return scenario_from_mapping(mapping, "scenario")


def _end_stamp(block: SimulatedBlock) -> int:
    return block.own_ship[-1].stamp


def main() -> int:
    """Run the node."""
    return run_node(ArraySimulator)


if __name__ == "__main__":
    sys.exit(main())
