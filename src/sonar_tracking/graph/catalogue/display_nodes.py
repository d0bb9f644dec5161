"""The node that shows where everything is, and what is heard and tracked (no ROS import)."""

from __future__ import annotations

from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_MARKERS,
    ACTIVE_THRESHOLD,
    ACTIVE_TRACKS,
    BEARING_MARKERS,
    BEARING_TRACKS,
    CONTACT_MARKERS,
    CONTACT_POINTS,
    CONTACTS,
    FIXED_TRANSFORMS,
    FUSED_MARKERS,
    FUSED_TRACKS,
    GATE_MARKERS,
    ODOMETRY,
    PASSIVE_MARKERS,
    PASSIVE_TRACKS,
    TRANSFORMS,
)
from sonar_tracking.scene.scene_configuration import SceneConfiguration

SCENE_PUBLISHER = NodeDescription(
    name="scene_publisher",
    module="sonar_tracking.graph.nodes.scene_publisher",
    description="shows RViz and Foxglove own ship, the sensors, and what they hear and track",
    configurations=(SceneConfiguration,),
    optional_inputs=(
        ODOMETRY,
        CONTACTS,
        ACTIVE_THRESHOLD,
        ACTIVE_TRACKS,
        PASSIVE_TRACKS,
        FUSED_TRACKS,
    ),
    topic_parameters={"bearing_topics": BEARING_TRACKS},
    markers=(
        TRANSFORMS,
        FIXED_TRANSFORMS,
        BEARING_MARKERS,
        PASSIVE_MARKERS,
        CONTACT_MARKERS,
        CONTACT_POINTS,
        GATE_MARKERS,
        ACTIVE_MARKERS,
        FUSED_MARKERS,
    ),
    is_display=True,
)
