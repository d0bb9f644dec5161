"""Protects which topics there are, and whose they are, as in the graph."""

from __future__ import annotations

from sonar_tracking.evaluation.offline.place_tracks import belonging, topics_of
from sonar_tracking.graph.catalogue.scenario_graph import started_nodes, with_published_topics
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
)

KINDS = ("active", "bearings", "passive")


def several_places() -> Scenario:
    """Return a scenario with arrays, sonars and buoys of own ship, its consort and a pier."""
    array = {"n_elements": 4}
    return scenario_from_mapping(
        {
            "own_ship": {},
            "consort": {"position": [1000.0, 0.0]},
            "array": array,
            "active_sonar": {},
            "bearing_sensors": [{"sensor_id": "buoy", "namespace": "buoy", "platform": "fixed"}],
            "stations": [
                {"namespace": "pier", "platform": "fixed", "array": array},
                {
                    "namespace": "consort",
                    "platform": "consort",
                    "array": array,
                    "active_sonar": {"ping_interval": 12.0},
                },
            ],
            "targets": [{"motion": {"kind": "kinematic", "position": [300.0, 900.0]}}],
            "nodes": {
                "tma_tracker": {},
                "track_fusion": {},
                "consort_tma_tracker": {},
                "consort_track_fusion": {},
            },
        },
        "places",
    )


def assert_as_in_the_graph(scenario: Scenario) -> None:
    """Assert that every fusion takes the topics that its node takes, in the same order."""
    nodes = started_nodes(scenario, "test")
    filled = with_published_topics(nodes, scenario.nodes, scenario.namespaces)
    places = [one.station for one in nodes if one.kind == "track_fusion"]
    assert places
    for place in places:
        prefix = f"{place}_" if place else ""
        for kind in KINDS:
            topics = belonging(getattr(topics_of(scenario), kind), place, places)
            parameter = f"{kind.removesuffix('s')}_topics"
            assert tuple(topics or [""]) == filled[f"{prefix}track_fusion"][parameter]


def test_topics_are_those_of_the_graph_in_its_order() -> None:
    assert_as_in_the_graph(several_places())
    for name in ("harbour_watch", "ships_in_company", "two_ships"):
        assert_as_in_the_graph(load_scenario(name))
