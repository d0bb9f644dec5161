"""Protects the graph of several stations: each has its trackers, and hears its own topics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.graph.catalogue.command_kinds import check_command
from sonar_tracking.graph.catalogue.node_catalogue import described
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.scenario_graph import (
    planned_nodes,
    started_nodes,
    with_published_topics,
)
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.graph.verbs.run_scenario import plan_scenario
from sonar_tracking.records.commands import CommandKind, OperatorCommand
from sonar_tracking.simulation.scenarios.scenario_mapping import scenario_from_mapping

ARRAY: dict[str, Any] = {"n_elements": 8, "snapshot_rate": 10.0}
SEA: dict[str, Any] = {
    "duration": 20.0,
    "array": ARRAY,
    "active_sonar": {"ping_interval": 10.0},
    "consort": {"position": [1000.0, 0.0]},
    "stations": [
        {"namespace": "bow", "array": ARRAY},
        {
            "namespace": "consort",
            "platform": "consort",
            "array": ARRAY,
            "active_sonar": {"ping_interval": 10.0},
        },
    ],
    "targets": [{"motion": {"kind": "kinematic", "position": [300.0, 900.0]}}],
    "nodes": {
        "tma_tracker": {},
        "track_fusion": {"foreign_topics": ["consort/own_tracks"], "ship": 1},
        "consort_track_fusion": {"foreign_topics": ["own_tracks", "/far/tracks"], "ship": 2},
    },
}


def planned(tmp_path: Path, **nodes: dict[str, Any]) -> GraphPlan:
    """Return the graph of the scenario, with parameters of more nodes."""
    mapping = {**SEA, "nodes": {**SEA["nodes"], **nodes}}
    scenario = scenario_from_mapping(mapping, "sea")
    return plan_scenario(scenario, RunOptions(), tmp_path, "sea")


def heard(node: PlannedNode) -> set[str]:
    """Return the names of what a node listens to, but for commands."""
    return {topic.name.lstrip("/") for topic in node.subscriptions} - {"operator/commands"}


@pytest.fixture
def nodes(tmp_path: Path) -> dict[str, PlannedNode]:
    return {node.name: node for node in planned(tmp_path).nodes}


def test_every_station_has_its_own_chain(nodes: dict[str, PlannedNode]) -> None:
    assert {name for name in nodes if name.startswith("bow_")} == {
        *("bow_array_simulator", "bow_subspace_estimator", "bow_bearing_tracker"),
    }
    assert heard(nodes["bow_bearing_tracker"]) == {"bow/array/subspaces"}
    assert heard(nodes["consort_hpda_tracker"]) == {
        *("consort/active/contacts", "consort/own_ship/odometry"),
    }
    assert nodes["consort_hpda_tracker"].parameters["station"] == "consort"
    told = {topic.name.lstrip("/") for topic in nodes["world_simulator"].publishers}
    assert told == {"truth/tracks", "own_ship/odometry", "consort/own_ship/odometry"}


def test_what_a_ship_hears_is_fused_by_the_nearest_fusion(nodes: dict[str, PlannedNode]) -> None:
    own, other = nodes["track_fusion"], nodes["consort_track_fusion"]
    assert own.parameters["active_topics"] == ("active/tracks",)
    assert own.parameters["bearing_topics"] == (
        *("passive/bearing_tracks", "bow/passive/bearing_tracks"),
    )
    assert other.parameters["active_topics"] == ("consort/active/tracks",)
    assert other.parameters["bearing_topics"] == ("consort/passive/bearing_tracks",)
    # There is no fusion of positions aboard the consort: own ship's has them all.
    assert "consort/passive/bearing_tracks" in nodes["tma_tracker"].parameters["bearing_topics"]
    assert "consort/own_tracks" in heard(own) and "consort/tracks" not in heard(own)
    # What another graph publishes is no part of this one.
    assert "own_tracks" in heard(other) and "far/tracks" not in heard(other)


def test_both_lists_can_be_commanded(tmp_path: Path) -> None:
    lists = planned(tmp_path).commanded_lists()
    assert lists["/consort/tracks"] == "consort/tracks" and lists["/tracks"] == "tracks"
    known = {name for name in lists.values() if "consort/" in name}
    assert known == {*("consort/tracks", "consort/active/tracks", "consort/passive/bearing_tracks")}
    command = OperatorCommand(stamp=1, kind=CommandKind.CHOOSE_SIDE, topic="consort/passive/tracks")
    check_command(command)
    with pytest.raises(InputError, match="cannot be done"):
        check_command(replace(command, topic="consort/tracks"))


def test_a_node_of_a_station_is_started_by_its_name(tmp_path: Path) -> None:
    plan = planned(tmp_path)
    node = next(one for one in plan.nodes if one.name == "bow_bearing_tracker")
    arguments = plan.process(node, tmp_path).arguments
    assert "__node:=bow_bearing_tracker" in arguments
    assert node.module.endswith("nodes.bearing_tracker")
    known = described(node.name, node.parameters)
    assert known is not None and (known.kind, known.station) == ("bearing_tracker", "bow")


@pytest.mark.parametrize(
    ("nodes", "sentence"),
    [
        ({"bow_hpda_tracker": {}}, "bow_hpda_tracker has nothing to do.*bow/active/contacts"),
        ({"bov_bearing_tracker": {}}, "bov_bearing_tracker.*did you mean bow_bearing_tracker"),
        ({"bow_bearing_tracker": {"station": "stern"}}, "station is 'stern', but"),
        ({"bow_subspace_estimator": {"source_count": 8}}, "bow_subspace_estimator.source_count"),
        (
            {
                "bow_subspace_estimator": {"method": "past"},
                "bow_bearing_tracker": {"method": "coherent"},
            },
            "coherent",
        ),
    ],
)
def test_what_does_not_fit_is_named(
    tmp_path: Path, nodes: dict[str, dict[str, Any]], sentence: str
) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        planned(tmp_path, **nodes)


def test_without_a_fusion_of_its_own_a_station_is_fused_by_own_ship() -> None:
    mapping = {**SEA, "nodes": {"track_fusion": {}}}
    scenario = scenario_from_mapping(mapping, "sea")
    started = started_nodes(scenario, "sea")
    given = with_published_topics(started, scenario.nodes, scenario.namespaces)
    assert given["track_fusion"]["active_topics"] == ("active/tracks", "consort/active/tracks")
    assert not any(node.name == "consort_track_fusion" for node in started)
    assert planned_nodes(started[:1], {"world_simulator": {}}, scenario.namespaces)
