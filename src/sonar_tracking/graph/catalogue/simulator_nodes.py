"""The nodes that simulate the world and what its sensors receive (no ROS import)."""

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

WORLD_SIMULATOR = NodeDescription(
    name="world_simulator",
    module="sonar_tracking.graph.nodes.world_simulator",
    description="publishes own ship and the true positions of the targets of a scenario",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(TRUE_TRACKS, ODOMETRY),
    station_outputs=(ODOMETRY,),
    section="own_ship",
)
ARRAY_SIMULATOR = NodeDescription(
    name="array_simulator",
    module="sonar_tracking.graph.nodes.array_simulator",
    description="publishes the snapshots of a scenario's array, and the true angles",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(SNAPSHOTS, TRUE_BEARING_TRACKS),
    section="array",
)
HYDROPHONE_SIMULATOR = NodeDescription(
    name="hydrophone_simulator",
    module="sonar_tracking.graph.nodes.hydrophone_simulator",
    description="publishes the element time series of a scenario's array, and the true angles",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(SAMPLES, TRUE_BEARING_TRACKS),
    section="hydrophones",
)
BEARING_SIMULATOR = NodeDescription(
    name="bearing_simulator",
    module="sonar_tracking.graph.nodes.bearing_simulator",
    description="publishes bearings and lines of a scenario's stations, and the true angles",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    station_outputs=(BEARING_TRACKS, FREQUENCY_LINES, TRUE_BEARING_TRACKS),
    section="bearing_sensors",
)
CONTACT_SIMULATOR = NodeDescription(
    name="contact_simulator",
    module="sonar_tracking.graph.nodes.contact_simulator",
    description="publishes the contacts of a scenario's active sonar",
    configurations=(SimulatorConfiguration, NodeConfiguration),
    inputs=(),
    outputs=(CONTACTS,),
    section="active_sonar",
)
SENSOR_SIMULATORS = (ARRAY_SIMULATOR, HYDROPHONE_SIMULATOR, BEARING_SIMULATOR, CONTACT_SIMULATOR)
"""One for each kind of sensor."""
