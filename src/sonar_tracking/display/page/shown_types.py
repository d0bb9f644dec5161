"""Types of the messages the live page makes frames of."""

from __future__ import annotations

from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE

COMMAND_TYPE = "sonar_tracking_msgs/msg/OperatorCommand"

SHOWN_TYPES = (
    ODOMETRY_TYPE,
    "sonar_tracking_msgs/msg/Tracks",
    "sonar_tracking_msgs/msg/BearingTracks",
    "sonar_tracking_msgs/msg/FrequencyLines",
    "sonar_tracking_msgs/msg/Contacts",
    "sonar_tracking_msgs/msg/DetectionThreshold",
    "sonar_tracking_msgs/msg/ArrayAlignments",
    "sonar_tracking_msgs/msg/ArraySnapshots",
    "sonar_tracking_msgs/msg/ArraySamples",
    COMMAND_TYPE,
    "diagnostic_msgs/msg/DiagnosticArray",
)
"""What the feed takes."""

KEPT_TYPES = (
    "sonar_tracking_msgs/msg/Tracks",
    "sonar_tracking_msgs/msg/BearingTracks",
    "sonar_tracking_msgs/msg/ArrayAlignments",
    COMMAND_TYPE,
)
"""Complete pictures and commands, which are kept for late readers."""
