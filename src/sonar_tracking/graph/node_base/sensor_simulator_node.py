"""Base of the nodes that simulate a sensor: they publish what it receives, and nothing else."""

from __future__ import annotations

from abc import abstractmethod

from sonar_tracking.errors import Severity
from sonar_tracking.graph.catalogue.simulator_nodes import WORLD_SIMULATOR
from sonar_tracking.graph.node_base.data_flow import DataOutput
from sonar_tracking.graph.node_base.scenario_begin import BeginListener
from sonar_tracking.graph.node_base.simulator_node import SimulatorNode
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.scenarios.scenario import Scenario

PATIENCE = 5 * NANOSECONDS
"""Until it is said that a simulator waits for the begin of the scenario, ns."""


class SensorSimulatorNode(SimulatorNode):
    """Publishes the data of a sensor when they are due.

    Without simulation time they begin when somebody listens to them, but not before the scenario,
    whose begin ``world_simulator`` tells.
    """

    _begin: BeginListener | None = None
    _waits_since: int | None = None

    @property
    @abstractmethod
    def main_output(self) -> DataOutput:
        """Publisher of the data."""

    def begin(self) -> None:
        """Read the scenario of the parameters and wait for the clock."""
        super().begin()
        # What follows of a block is timed from its announcement.
        self.main_output.is_timed = bool(self.get_parameter("use_sim_time").value)

    def began(self, scenario: Scenario, now: int) -> int | None:
        """Return when the scenario has begun, ns; None = not yet, or nobody listens yet."""
        if self._begin is None:
            self._begin = BeginListener(self)
        if self.main_output.publisher.get_subscription_count() == 0:
            return None
        if self._begin.stamp is None:
            self._say_that_it_waits(now)
        return self._begin.stamp

    def _say_that_it_waits(self, now: int) -> None:
        if self._waits_since is None:
            self._waits_since = now
        elif now - self._waits_since > PATIENCE:
            self.report(
                "scenario",
                "begin",
                Severity.WARN,
                f"waits for {WORLD_SIMULATOR.name}, which tells when the scenario begins and where "
                "own ship is; start it, too.",
            )
