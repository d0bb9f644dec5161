"""The nodes that simulate a sensor (no ROS import)."""

from __future__ import annotations

from sonar_tracking.graph.catalogue.node_configuration import (
    NodeConfiguration,
    SimulatorConfiguration,
)
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    CONTACTS,
    FREQUENCY_LINES,
    ODOMETRY,
    SAMPLES,
    SNAPSHOTS,
    TRUE_BEARING_TRACKS,
    TRUE_TRACKS,
)

ARRAY_SIMULATOR = NodeDescription(
    name="array_simulator",
    module="sonar_tracking.graph.nodes.array_simulator",
    description="publishes the snapshots, own ship and truth of a scenario",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(SNAPSHOTS, TRUE_BEARING_TRACKS, TRUE_TRACKS, ODOMETRY),
    section="array",
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
CONTACT_SIMULATOR = NodeDescription(
    name="contact_simulator",
    module="sonar_tracking.graph.nodes.contact_simulator",
    description="publishes the contacts, own ship and truth of a scenario with an active sonar",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(CONTACTS, TRUE_TRACKS, ODOMETRY),
    section="active_sonar",
)
