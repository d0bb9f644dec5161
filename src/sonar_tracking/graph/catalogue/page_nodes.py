"""The node that serves the live page (no ROS import)."""

from __future__ import annotations

from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription

OPERATOR_DISPLAY = NodeDescription(
    name="operator_display",
    module="sonar_tracking.graph.nodes.operator_display",
    description="serves the live page to browsers: plan, records, tracks, health",
    configurations=(PageConfiguration,),
    on_request=True,
    is_display=True,
)
