"""All nodes of the graph: what they are called, take, give and can be told (no ROS import).

The documentation, the launch file and the orchestration read it, and so do the nodes themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import ParameterDescription, describe
from sonar_tracking.graph.node_configuration import ArraySimulatorConfiguration, NodeConfiguration
from sonar_tracking.graph.topics import (
    BEARING_TRACKS,
    ODOMETRY,
    SNAPSHOTS,
    SUBSPACES,
    TRUE_BEARING_TRACKS,
    TRUE_TRACKS,
    Topic,
)
from sonar_tracking.passive.bearing_tracker_configuration import BearingTrackerConfiguration
from sonar_tracking.passive.subspace_configuration import SubspaceConfiguration


@dataclass(frozen=True)
class NodeDescription:
    """One node of the graph.

    Attributes
    ----------
    name : str
        Default name of the node and of its executable.
    module : str
        Run as ``python -m module``.
    description : str
        One line of what it does.
    configurations : tuple of type
        Configuration dataclasses its ROS parameters are declared from.
    inputs, outputs : tuple of Topic
        Data topics it subscribes to and publishes.
    serves_clock : bool
        True for a source of data: it emits everything due up to ``/clock``.
    """

    name: str
    module: str
    description: str
    configurations: tuple[type, ...]
    inputs: tuple[Topic, ...]
    outputs: tuple[Topic, ...]
    serves_clock: bool = False

    @property
    def parameters(self) -> tuple[ParameterDescription, ...]:
        """Descriptions of all parameters of the node."""
        return tuple(entry for each in self.configurations for entry in describe(each))


ARRAY_SIMULATOR = NodeDescription(
    name="array_simulator",
    module="sonar_tracking.graph.array_simulator",
    description="publishes the snapshots, own ship and truth of a scenario",
    configurations=(ArraySimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(SNAPSHOTS, TRUE_BEARING_TRACKS, TRUE_TRACKS, ODOMETRY),
    serves_clock=True,
)
SUBSPACE_ESTIMATOR = NodeDescription(
    name="subspace_estimator",
    module="sonar_tracking.graph.subspace_estimator",
    description="follows the signal subspace of an array through its snapshots",
    configurations=(SubspaceConfiguration, NodeConfiguration),
    inputs=(SNAPSHOTS,),
    outputs=(SUBSPACES,),
)
BEARING_TRACKER = NodeDescription(
    name="bearing_tracker",
    module="sonar_tracking.graph.bearing_tracker",
    description="tracks the arrival angles of several targets from signal subspaces",
    configurations=(BearingTrackerConfiguration, NodeConfiguration),
    inputs=(SUBSPACES,),
    outputs=(BEARING_TRACKS,),
)

NODES = {
    description.name: description
    for description in (ARRAY_SIMULATOR, SUBSPACE_ESTIMATOR, BEARING_TRACKER)
}
"""Every node by its name, sources first, in the order data flow."""
