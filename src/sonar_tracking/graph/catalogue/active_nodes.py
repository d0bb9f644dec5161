"""The node that finds positions from the contacts of an active sonar (no ROS import)."""

from __future__ import annotations

from sonar_tracking.active.contacts.contact_defaults import ContactDefaultsConfiguration
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.contacts.sensor_location import MountingConfiguration
from sonar_tracking.graph.catalogue.node_configuration import NodeConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_THRESHOLD,
    ACTIVE_TRACKS,
    CONTACTS,
    ODOMETRY,
)

HPDA_TRACKER = NodeDescription(
    name="hpda_tracker",
    module="sonar_tracking.graph.nodes.hpda_tracker",
    description="tracks the positions of several targets from contacts in clutter",
    configurations=(
        ContactTrackerConfiguration,
        ContactDefaultsConfiguration,
        MountingConfiguration,
        NodeConfiguration,
    ),
    inputs=(CONTACTS,),
    optional_inputs=(ODOMETRY,),
    outputs=(ACTIVE_TRACKS, ACTIVE_THRESHOLD),
    commanded_topic=ACTIVE_TRACKS,
)
