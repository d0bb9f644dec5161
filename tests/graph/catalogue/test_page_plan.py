"""The page of a graph listens to that graph alone, and is told where its sensors are."""

from __future__ import annotations

from dataclasses import replace

from sonar_tracking.graph.catalogue.page_plan import PageOptions, planned_page
from sonar_tracking.graph.catalogue.topics import FUSED_TRACKS, SNAPSHOTS, SUBSPACES

OPTIONS = PageOptions(8080, "127.0.0.1", browser=True)


def test_no_page_is_planned_unless_asked_for() -> None:
    assert planned_page(None, [FUSED_TRACKS], {}, "") == ()


def test_the_page_hears_the_topics_of_its_own_graph_by_full_names() -> None:
    own = [replace(topic, name=f"/shipA/{topic.name}") for topic in (FUSED_TRACKS, SUBSPACES)]
    (node,) = planned_page(OPTIONS, [*own, SNAPSHOTS], {}, "scenario")
    assert node.parameters["topics"] == ("/shipA/tracks", "/array/snapshots")
    assert node.parameters["types"] == (FUSED_TRACKS.message_type, SNAPSHOTS.message_type)
    assert not node.publishers
    assert not node.needs_clock


def test_sensors_are_where_the_scene_has_them() -> None:
    scene = {"array_mounting_yaw_deg": 180.0, "marker_size": 3.0}
    (node,) = planned_page(OPTIONS, [], {"scene_publisher": scene}, "scenario")
    assert node.parameters["array_mounting_yaw_deg"] == 180.0
    assert "marker_size" not in node.parameters


def test_the_browser_is_opened_once() -> None:
    (node,) = planned_page(OPTIONS, [], {}, "scenario")
    assert node.comes_back
    assert node.parameters["open_browser"] is True
    assert node.parameters_again == {"open_browser": False}
