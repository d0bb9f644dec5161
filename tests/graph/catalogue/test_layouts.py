"""Protects the layouts for RViz and Foxglove: every picture is in both, by the name it has."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import yaml

from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.topics import DIAGNOSTICS, Topic, TopicKind

CONFIG = Path(__file__).resolve().parents[3] / "config"
RVIZ: dict[str, Any] = yaml.safe_load((CONFIG / "rviz" / "sonar_tracking.rviz").read_text())
FOXGLOVE: dict[str, Any] = json.loads((CONFIG / "foxglove" / "sonar_tracking.json").read_text())

TYPES = {
    "rviz_default_plugins/MarkerArray": "visualization_msgs/msg/MarkerArray",
    "rviz_default_plugins/PointCloud2": "sensor_msgs/msg/PointCloud2",
    "rviz_default_plugins/Odometry": "nav_msgs/msg/Odometry",
}
"""What the displays of RViz take, by their classes; Grid and TF are given no topic."""

PANELS = {"3D", "DiagnosticSummary", "Plot", "RawMessages", "Tab"}
"""The kinds of panels of Foxglove and Lichtblick that are used."""

TOPICS: dict[str, Topic] = {
    f"/{topic.name.lstrip('/')}": topic
    for node in NODES.values()
    for topic in (*node.outputs, *node.station_outputs, *node.markers)
} | {DIAGNOSTICS.name: DIAGNOSTICS}
PICTURES = {
    name
    for node in NODES.values()
    for topic in node.markers
    if not (name := f"/{topic.name.lstrip('/')}").startswith("/tf")
}


def test_rviz_shows_every_picture_by_its_type_and_quality() -> None:
    manager = RVIZ["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == "map"
    assert manager["Views"]["Current"]["Class"] == "rviz_default_plugins/TopDownOrtho"
    displays = manager["Displays"]
    assert all(display["Enabled"] and display["Name"] for display in displays)
    shown = {each["Topic"]["Value"]: each for each in displays if "Topic" in each}
    without_topic = {each["Class"] for each in displays if "Topic" not in each}
    assert without_topic == {"rviz_default_plugins/Grid", "rviz_default_plugins/TF"}
    assert set(shown) >= PICTURES
    for name, display in shown.items():
        assert TYPES[display["Class"]] == TOPICS[name].message_type
        # A reader that asks for the last picture hears nothing of who does not keep it.
        kept = display["Topic"]["Durability Policy"] == "Transient Local"
        assert not kept or TOPICS[name].kind is TopicKind.TRACKS


def test_foxglove_shows_every_picture_and_the_state_of_the_nodes() -> None:
    panels = FOXGLOVE["configById"]
    assert {name.partition("!")[0] for name in panels} == PANELS
    scene = panels["3D!scene"]
    assert scene["followTf"] == "map"
    assert set(scene["topics"]) == PICTURES
    assert all(settings["visible"] for settings in scene["topics"].values())
    assert panels["DiagnosticSummary!nodes"]["topicToRender"] in TOPICS
    paths = [path["value"] for path in panels["Plot!existence"]["paths"]]
    paths += [each["topicPath"] for name, each in panels.items() if name.startswith("Raw")]
    assert {path.partition(".")[0] for path in paths} <= set(TOPICS)


def leaves(layout: Any) -> list[str]:
    """Return the panels of a layout."""
    if isinstance(layout, str):
        return [layout]
    assert layout["direction"] in ("row", "column")
    return [*leaves(layout["first"]), *leaves(layout["second"])]


def test_every_panel_of_foxglove_has_its_place() -> None:
    panels = FOXGLOVE["configById"]
    placed = leaves(FOXGLOVE["layout"])
    for name in list(placed):
        placed += [tab["layout"] for tab in panels[name].get("tabs", ())]
    assert sorted(placed) == sorted(panels)
    assert {"globalVariables", "userNodes", "playbackConfig"} <= set(FOXGLOVE)
