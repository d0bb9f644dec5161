"""A scenario starts the nodes its sensors need, connected by the topics they publish."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue import scenario_graph
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.scenario_graph import (
    NO_TOPIC,
    planned_nodes,
    started_nodes,
    with_published_topics,
)
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    FREQUENCY_LINES,
    PASSIVE_TRACKS,
    TopicRole,
)
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
)

STATIONS = NodeDescription(
    name="stations",
    module="",
    description="",
    configurations=(),
    inputs=(),
    outputs=(),
    section="array",
    station_outputs=(BEARING_TRACKS,),
)
ANALYSIS = NodeDescription(
    name="analysis",
    module="",
    description="",
    configurations=(),
    inputs=(),
    outputs=(PASSIVE_TRACKS,),
    on_request=True,
    topic_parameters={"bearing_topics": BEARING_TRACKS, "line_topics": FREQUENCY_LINES},
)
NAMESPACES = {"array": ("", "north")}


@pytest.fixture
def small_catalogue(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scenario_graph, "NODES", {node.name: node for node in (STATIONS, ANALYSIS)})


def scenario(**nodes: dict[str, Any]) -> Scenario:
    """Return a scenario that names some nodes."""
    return replace(load_scenario("doa_fusion"), nodes=nodes)


def test_an_array_starts_the_passive_chain() -> None:
    names = [node.name for node in started_nodes(load_scenario("doa_fusion"), "here")]
    assert names == [
        "world_simulator",
        "array_simulator",
        "subspace_estimator",
        "bearing_tracker",
        "scene_publisher",
    ]


SHARED_WORLD = {
    "array": {"n_elements": 12, "spacing": 1.0, "center_frequency": 300.0, "bandwidth": 6.0},
    "hydrophones": {},
    "active_sonar": {},
    "bearing_sensors": [{"sensor_id": "buoy", "namespace": "buoy", "platform": "fixed"}],
    "nodes": {"band_demodulator": {"center_frequency": 300.0}, "tma_tracker": {}},
}


def test_sensors_of_every_kind_share_a_world() -> None:
    world = scenario_from_mapping(SHARED_WORLD, "harbour.yaml")
    names = [node.name for node in started_nodes(world, "harbour.yaml")]
    assert names == [
        "world_simulator",
        "hydrophone_simulator",
        "bearing_simulator",
        "contact_simulator",
        "band_demodulator",
        "subspace_estimator",
        "bearing_tracker",
        "line_tracker",
        "tma_tracker",
        "hpda_tracker",
        "scene_publisher",
    ]


def test_a_station_beside_an_array_needs_a_namespace() -> None:
    stations = [{"sensor_id": "buoy", "platform": "fixed"}]
    world = scenario_from_mapping({**SHARED_WORLD, "bearing_sensors": stations}, "harbour.yaml")
    with pytest.raises(
        ConfigurationError,
        match="bearing_simulator would publish truth/bearing_tracks a second time; give every "
        "station under bearing_sensors a namespace",
    ):
        started_nodes(world, "harbour.yaml")


def test_a_node_without_its_sensor_is_refused() -> None:
    sonar = scenario_from_mapping(
        {"active_sonar": {}, "nodes": {"bearing_tracker": {}}}, "harbour.yaml"
    )
    with pytest.raises(ConfigurationError, match="bearing_tracker has nothing"):
        started_nodes(sonar, "harbour.yaml")


def test_topics_have_one_publisher(monkeypatch: pytest.MonkeyPatch) -> None:
    twin = replace(STATIONS, name="twin")
    monkeypatch.setattr(scenario_graph, "NODES", {"stations": STATIONS, "twin": twin})
    with pytest.raises(ConfigurationError, match="twin would publish passive/bearing_tracks a sec"):
        started_nodes(scenario(), "here")


@pytest.mark.usefixtures("small_catalogue")
def test_a_node_on_request_is_started_when_it_is_named() -> None:
    assert started_nodes(scenario(), "here") == (STATIONS,)
    assert started_nodes(scenario(analysis={}), "here") == (STATIONS, ANALYSIS)


@pytest.mark.usefixtures("small_catalogue")
def test_every_station_is_listened_to() -> None:
    nodes = (STATIONS, ANALYSIS)
    settings = with_published_topics(nodes, {}, NAMESPACES)
    assert settings == {
        "analysis": {
            "bearing_topics": ("passive/bearing_tracks", "north/passive/bearing_tracks"),
            "line_topics": (NO_TOPIC,),
        }
    }
    stations, analysis = planned_nodes(nodes, {"stations": {}, **settings}, NAMESPACES)
    assert [topic.name for topic in analysis.subscriptions] == [
        "passive/bearing_tracks",
        "north/passive/bearing_tracks",
    ]
    assert {topic.role for topic in stations.publishers} == {TopicRole.INPUT}


@pytest.mark.usefixtures("small_catalogue")
def test_topics_that_were_chosen_are_kept() -> None:
    chosen = {"analysis": {"bearing_topics": ("north/passive/bearing_tracks",)}}
    filled = with_published_topics((STATIONS, ANALYSIS), chosen, NAMESPACES)
    assert filled["analysis"]["bearing_topics"] == ("north/passive/bearing_tracks",)
