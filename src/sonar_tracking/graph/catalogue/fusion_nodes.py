"""The node that makes one track list of all others (no ROS import)."""

from __future__ import annotations

from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.graph.catalogue.node_configuration import (
    FusionInputConfiguration,
    NodeConfiguration,
)
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    ALIGNMENTS,
    BEARING_TRACKS,
    FUSED_TRACKS,
    ODOMETRY,
    OWN_TRACKS,
    PASSIVE_TRACKS,
)

TRACK_FUSION = NodeDescription(
    name="track_fusion",
    module="sonar_tracking.graph.nodes.track_fusion",
    description="makes one track list of all others, and finds how arrays are misaligned",
    configurations=(TrackFusionConfiguration, FusionInputConfiguration, NodeConfiguration),
    inputs=(),
    optional_inputs=(ODOMETRY,),
    outputs=(FUSED_TRACKS, OWN_TRACKS, ALIGNMENTS),
    topic_parameters={
        "active_topics": ACTIVE_TRACKS,
        "bearing_topics": BEARING_TRACKS,
        "passive_topics": PASSIVE_TRACKS,
    },
    named_inputs={"foreign_topics": FUSED_TRACKS},
    on_request=True,
    commanded_topic=FUSED_TRACKS,
)
