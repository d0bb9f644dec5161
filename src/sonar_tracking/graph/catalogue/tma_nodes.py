"""The node that finds positions from bearings and frequency lines (no ROS import)."""

from __future__ import annotations

from sonar_tracking.graph.catalogue.node_configuration import (
    NodeConfiguration,
    TmaInputConfiguration,
)
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    FREQUENCY_LINES,
    ODOMETRY,
    PASSIVE_TRACKS,
    STATION_ALIGNMENTS,
)
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

TMA_TRACKER = NodeDescription(
    name="tma_tracker",
    module="sonar_tracking.graph.nodes.tma_tracker",
    description="finds positions and velocities from bearing tracks and frequency lines",
    configurations=(TmaTrackerConfiguration, TmaInputConfiguration, NodeConfiguration),
    inputs=(),
    optional_inputs=(ODOMETRY,),
    outputs=(PASSIVE_TRACKS, STATION_ALIGNMENTS),
    topic_parameters={"bearing_topics": BEARING_TRACKS, "line_topics": FREQUENCY_LINES},
    on_request=True,
    commanded_topic=PASSIVE_TRACKS,
)
