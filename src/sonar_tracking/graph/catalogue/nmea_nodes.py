"""The node that tells chart plotters of the tracks (no ROS import)."""

from __future__ import annotations

from sonar_tracking.graph.catalogue.node_configuration import NodeConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import FUSED_TRACKS, ODOMETRY
from sonar_tracking.scene.nmea_configuration import NmeaOutputConfiguration

NMEA_OUTPUT = NodeDescription(
    name="nmea_output",
    module="sonar_tracking.graph.nodes.nmea_output",
    description="sends the fused tracks to chart plotters, as NMEA 0183 over UDP",
    configurations=(NmeaOutputConfiguration, NodeConfiguration),
    inputs=(FUSED_TRACKS,),
    optional_inputs=(ODOMETRY,),
    on_request=True,
)
