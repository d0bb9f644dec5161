"""How the trackers would be told where own ship's sensors are that are shown."""

from __future__ import annotations

from sonar_tracking.active.contacts.sensor_location import MountingConfiguration
from sonar_tracking.scene.shown_mountings import ShownMountings
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration


def array_as_told(shown: ShownMountings) -> TmaTrackerConfiguration:
    """Return how the tracker of bearings would be told where the array is."""
    return TmaTrackerConfiguration(
        mounting_x=shown.array_mounting_x,
        mounting_y=shown.array_mounting_y,
        mounting_yaw_deg=shown.array_mounting_yaw_deg,
    )


def sonar_as_told(shown: ShownMountings) -> MountingConfiguration:
    """Return how the tracker of contacts would be told where the active sonar is."""
    return MountingConfiguration(
        shown.sonar_mounting_x, shown.sonar_mounting_y, shown.sonar_mounting_yaw_deg
    )
