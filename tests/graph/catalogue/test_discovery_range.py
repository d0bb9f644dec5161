"""Protects the graph from the network: without a word of its user, nobody else can find it."""

from __future__ import annotations

import pytest

from sonar_tracking.graph.catalogue.discovery_range import (
    default_range,
    is_confined,
    range_in_words,
)

RANGE, PEERS, SERVER = (
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ROS_DISCOVERY_SERVER",
)


@pytest.mark.parametrize("environment", [{}, {RANGE: ""}, {RANGE: "LOCALHOST"}, {SERVER: ""}])
def test_a_graph_stays_on_its_machine(environment: dict[str, str]) -> None:
    asked = {**environment, **default_range(environment)}
    assert asked[RANGE] == "LOCALHOST"
    assert is_confined(environment)
    assert range_in_words(environment).startswith("discovery: this machine only")


@pytest.mark.parametrize(
    ("environment", "word"),
    [
        ({RANGE: "SUBNET"}, "SUBNET"),
        ({RANGE: "OFF"}, "OFF"),
        ({SERVER: "10.0.0.1:11811"}, "10.0.0.1:11811"),
    ],
)
def test_what_the_user_has_chosen_is_left_alone(environment: dict[str, str], word: str) -> None:
    assert default_range(environment) == {}
    assert not is_confined(environment)
    assert word in range_in_words(environment)


def test_static_peers_are_reached_and_nobody_else() -> None:
    environment = {PEERS: "10.0.0.2"}
    assert default_range(environment) == {RANGE: "LOCALHOST"}
    assert not is_confined(environment)
    assert range_in_words(environment) == "discovery: this machine and 10.0.0.2 (ROS_STATIC_PEERS)"


def test_the_older_variable_is_understood() -> None:
    environment = {"ROS_LOCALHOST_ONLY": "1"}
    assert default_range(environment) == {}
    assert is_confined(environment)
