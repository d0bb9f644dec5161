"""All nodes of the graph: what they are called, take, give and can be told (no ROS import).

The documentation, the launch file and the orchestration read it, and so do the nodes themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sonar_tracking.active.contacts.contact_defaults import ContactDefaultsConfiguration
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.contacts.sensor_location import MountingConfiguration
from sonar_tracking.configuration import ParameterDescription, describe
from sonar_tracking.graph.catalogue.node_configuration import (
    NodeConfiguration,
    SimulatorConfiguration,
    TmaInputConfiguration,
)
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_MARKERS,
    ACTIVE_THRESHOLD,
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    CONTACTS,
    FREQUENCY_LINES,
    LOFAR,
    ODOMETRY,
    PASSIVE_MARKERS,
    PASSIVE_TRACKS,
    SAMPLES,
    SNAPSHOTS,
    SUBSPACES,
    TRUE_BEARING_TRACKS,
    TRUE_TRACKS,
    Topic,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import BandDemodulatorConfiguration
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration


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
    optional_inputs : tuple of Topic
        Data topics it subscribes to, but does without where nobody publishes them.
    section : str
        Of a source of data: the section of a scenario it simulates. It emits everything due up to
        ``/clock``.
    on_request : bool
        Started only if the scenario names it under ``nodes``, not whenever its inputs are there.
    topic_parameters : mapping of str to Topic
        Inputs that may be several topics of one kind, by the parameter that lists their names;
        a scenario that does not set the parameter gets whatever its nodes publish. The first kind
        is needed, the others are optional.
    station_outputs : tuple of Topic
        Published once for every station of the section, in the namespace of the station.
    markers : tuple of Topic
        Pictures for RViz and Foxglove; they are neither recorded nor compared.
    """

    name: str
    module: str
    description: str
    configurations: tuple[type, ...]
    inputs: tuple[Topic, ...]
    outputs: tuple[Topic, ...]
    section: str = ""
    on_request: bool = False
    topic_parameters: Mapping[str, Topic] = field(default_factory=dict)
    station_outputs: tuple[Topic, ...] = ()
    markers: tuple[Topic, ...] = ()
    optional_inputs: tuple[Topic, ...] = ()

    @property
    def serves_clock(self) -> bool:
        """Whether it is a source of data."""
        return bool(self.section)

    @property
    def parameters(self) -> tuple[ParameterDescription, ...]:
        """Descriptions of all parameters of the node."""
        return tuple(entry for each in self.configurations for entry in describe(each))


ARRAY_SIMULATOR = NodeDescription(
    name="array_simulator",
    module="sonar_tracking.graph.nodes.array_simulator",
    description="publishes the snapshots, own ship and truth of a scenario",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(SNAPSHOTS, TRUE_BEARING_TRACKS, TRUE_TRACKS, ODOMETRY),
    section="array",
)
SUBSPACE_ESTIMATOR = NodeDescription(
    name="subspace_estimator",
    module="sonar_tracking.graph.nodes.subspace_estimator",
    description="follows the signal subspace of an array through its snapshots",
    configurations=(SubspaceConfiguration, NodeConfiguration),
    inputs=(SNAPSHOTS,),
    outputs=(SUBSPACES,),
)
BEARING_TRACKER = NodeDescription(
    name="bearing_tracker",
    module="sonar_tracking.graph.nodes.bearing_tracker",
    description="tracks the arrival angles of several targets from signal subspaces",
    configurations=(BearingTrackerConfiguration, NodeConfiguration),
    inputs=(SUBSPACES,),
    outputs=(BEARING_TRACKS,),
)
HYDROPHONE_SIMULATOR = NodeDescription(
    name="hydrophone_simulator",
    module="sonar_tracking.graph.nodes.hydrophone_simulator",
    description="publishes the element time series, own ship and truth of a scenario",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(SAMPLES, TRUE_BEARING_TRACKS, TRUE_TRACKS, ODOMETRY),
    section="hydrophones",
)
BAND_DEMODULATOR = NodeDescription(
    name="band_demodulator",
    module="sonar_tracking.graph.nodes.band_demodulator",
    description="takes the snapshots of one narrow band out of element time series",
    configurations=(BandDemodulatorConfiguration, NodeConfiguration),
    inputs=(SAMPLES,),
    outputs=(SNAPSHOTS,),
)
LINE_TRACKER = NodeDescription(
    name="line_tracker",
    module="sonar_tracking.graph.nodes.line_tracker",
    description="finds and follows the frequency lines of every tracked bearing",
    configurations=(LineTrackerConfiguration, NodeConfiguration),
    inputs=(SAMPLES, BEARING_TRACKS),
    outputs=(FREQUENCY_LINES, LOFAR),
)
CONTACT_SIMULATOR = NodeDescription(
    name="contact_simulator",
    module="sonar_tracking.graph.nodes.contact_simulator",
    description="publishes the contacts, own ship and truth of a scenario with an active sonar",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(CONTACTS, TRUE_TRACKS, ODOMETRY),
    section="active_sonar",
)
HPDA_TRACKER = NodeDescription(
    name="hpda_tracker",
    module="sonar_tracking.graph.nodes.hpda_tracker",
    description="tracks the positions of several targets from contacts in clutter",
    configurations=(
        ContactTrackerConfiguration,
        ContactDefaultsConfiguration,
        MountingConfiguration,
        NodeConfiguration,
    ),
    inputs=(CONTACTS,),
    optional_inputs=(ODOMETRY,),
    outputs=(ACTIVE_TRACKS, ACTIVE_THRESHOLD),
    markers=(ACTIVE_MARKERS,),
)

BEARING_SIMULATOR = NodeDescription(
    name="bearing_simulator",
    module="sonar_tracking.graph.nodes.bearing_simulator",
    description="publishes bearings and frequency lines of the stations of a scenario, and truth",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(TRUE_TRACKS, ODOMETRY),
    station_outputs=(BEARING_TRACKS, FREQUENCY_LINES, TRUE_BEARING_TRACKS),
    section="bearing_sensors",
)
TMA_TRACKER = NodeDescription(
    name="tma_tracker",
    module="sonar_tracking.graph.nodes.tma_tracker",
    description="finds positions and velocities from bearing tracks and frequency lines",
    configurations=(TmaTrackerConfiguration, TmaInputConfiguration, NodeConfiguration),
    inputs=(),
    optional_inputs=(ODOMETRY,),
    outputs=(PASSIVE_TRACKS,),
    topic_parameters={"bearing_topics": BEARING_TRACKS, "line_topics": FREQUENCY_LINES},
    markers=(PASSIVE_MARKERS,),
    on_request=True,
)

NODES = {
    description.name: description
    for description in (
        ARRAY_SIMULATOR,
        HYDROPHONE_SIMULATOR,
        BEARING_SIMULATOR,
        CONTACT_SIMULATOR,
        BAND_DEMODULATOR,
        SUBSPACE_ESTIMATOR,
        BEARING_TRACKER,
        LINE_TRACKER,
        TMA_TRACKER,
        HPDA_TRACKER,
    )
}
"""Every node by its name, sources first, in the order data flow."""
