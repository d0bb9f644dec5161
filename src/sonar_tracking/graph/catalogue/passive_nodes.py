"""The nodes from element time series to bearings and frequency lines (no ROS import)."""

from __future__ import annotations

from sonar_tracking.graph.catalogue.node_configuration import NodeConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    FREQUENCY_LINES,
    LOFAR,
    SAMPLES,
    SNAPSHOTS,
    SUBSPACES,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_configuration import BandDemodulatorConfiguration
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration

BAND_DEMODULATOR = NodeDescription(
    name="band_demodulator",
    module="sonar_tracking.graph.nodes.band_demodulator",
    description="takes the snapshots of one narrow band out of element time series",
    configurations=(BandDemodulatorConfiguration, NodeConfiguration),
    inputs=(SAMPLES,),
    outputs=(SNAPSHOTS,),
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
    commanded_topic=BEARING_TRACKS,
)
LINE_TRACKER = NodeDescription(
    name="line_tracker",
    module="sonar_tracking.graph.nodes.line_tracker",
    description="finds and follows the frequency lines of every tracked bearing",
    configurations=(LineTrackerConfiguration, NodeConfiguration),
    inputs=(SAMPLES, BEARING_TRACKS),
    outputs=(FREQUENCY_LINES, LOFAR),
)
