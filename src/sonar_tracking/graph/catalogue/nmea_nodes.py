"""The nodes that speak NMEA 0183: to chart plotters, and with receivers (no ROS import)."""

from __future__ import annotations

from sonar_tracking.bags.nmea.nmea_input_configuration import (
    AisTruthConfiguration,
    OwnShipNmeaConfiguration,
)
from sonar_tracking.graph.catalogue.node_configuration import NodeConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import FUSED_TRACKS, ODOMETRY, TRUE_TRACKS
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
OWN_SHIP_NMEA = NodeDescription(
    name="own_ship_nmea",
    module="sonar_tracking.graph.nodes.own_ship_nmea",
    description="own ship from a navigation receiver, NMEA 0183 over UDP",
    configurations=(OwnShipNmeaConfiguration, NodeConfiguration),
    outputs=(ODOMETRY,),
    is_live=True,
)
AIS_TRUTH = NodeDescription(
    name="ais_truth",
    module="sonar_tracking.graph.nodes.ais_truth",
    description="the ships around by their AIS over UDP, as the truth",
    configurations=(AisTruthConfiguration, NodeConfiguration),
    optional_inputs=(ODOMETRY,),
    outputs=(TRUE_TRACKS,),
    is_live=True,
)
