"""The node that shows where everything is (no ROS import)."""

from __future__ import annotations

from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    CONTACTS,
    FIXED_TRANSFORMS,
    ODOMETRY,
    TRANSFORMS,
)
from sonar_tracking.scene.scene_configuration import SceneConfiguration

SCENE_PUBLISHER = NodeDescription(
    name="scene_publisher",
    module="sonar_tracking.graph.nodes.scene_publisher",
    description="shows RViz and Foxglove where own ship and the sensors are",
    configurations=(SceneConfiguration,),
    optional_inputs=(ODOMETRY, CONTACTS),
    topic_parameters={"bearing_topics": BEARING_TRACKS},
    markers=(TRANSFORMS, FIXED_TRANSFORMS),
    is_display=True,
)
