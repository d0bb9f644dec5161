"""Parameters of the recorder, which has no configuration: it takes any topics (no ROS import)."""

from __future__ import annotations

RECORDER = "recorder"
"""Name of the node."""

RECORDER_PARAMETERS: dict[str, str] = {
    "output": "directory of the bag; if it exists, the next free <output>_2, _3, ... is taken",
    "topics": "resolved names of the topics to record",
    "types": "their message types, e.g. nav_msgs/msg/Odometry",
    "roles": "their roles: input, output, truth, display or other; empty = by name and type",
    "recording": "what the bag records of its making: JSON text, or path of a JSON file",
    "flow_depth": "messages kept per topic; at least twice the flow window of the time master",
}
"""Parameters of the node and what they are; all are read-only."""
