"""The nodes that show where everything is, and what is heard and tracked (no ROS import)."""

from __future__ import annotations

from sonar_tracking.display.page.page_configuration import PageConfiguration
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
    optional_inputs=(ODOMETRY, CONTACTS, ACTIVE_THRESHOLD, ACTIVE_TRACKS, PASSIVE_TRACKS),
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
    ),
    is_display=True,
)

OPERATOR_DISPLAY = NodeDescription(
    name="operator_display",
    module="sonar_tracking.graph.nodes.operator_display",
    description="serves the live page to browsers: plan, records, tracks, health",
    configurations=(PageConfiguration,),
    on_request=True,
    is_display=True,
)
