"""Protects the names of a graph: below a namespace, by rules, and refused where they cannot be."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, graph_names
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    CONTACTS,
    ODOMETRY,
    TRUE_TRACKS,
)

GRAPH = (CONTACTS, ACTIVE_TRACKS, ODOMETRY, TRUE_TRACKS)


def test_without_a_wish_everything_is_in_the_root() -> None:
    assert graph_names([], "") == graph_names([], "/") == ROOT_NAMES
    assert ROOT_NAMES.clock == "/clock"
    assert ROOT_NAMES.of(CONTACTS) == "/active/contacts"
    assert ROOT_NAMES.noted(GRAPH) == {}


@pytest.mark.parametrize("text", ["shipA", "/shipA", "shipA/", " /shipA/ "])
def test_a_namespace_goes_before_everything_that_is_not_absolute(text: str) -> None:
    names = graph_names([], text)
    assert names.namespace == "/shipA"
    assert names.clock == "/shipA/clock"
    assert names.of_node("hpda_tracker") == "/shipA/hpda_tracker"
    assert names.of(CONTACTS) == "/shipA/active/contacts"
    assert names.of(replace(CONTACTS, name="/sonar/contacts")) == "/sonar/contacts"


@pytest.mark.parametrize("old", ["active/tracks", "/active/tracks", "/shipA/active/tracks"])
@pytest.mark.parametrize(("new", "full"), [("picture", "/shipA/picture"), ("/a/b", "/a/b")])
def test_a_rule_is_found_by_any_name_of_its_topic(old: str, new: str, full: str) -> None:
    names = graph_names([f"{old}:={new}"], "shipA")
    names.check(GRAPH)
    assert names.of(ACTIVE_TRACKS) == full
    assert names.of(CONTACTS) == "/shipA/active/contacts"
    # A recording notes what its topics are, so that a replay finds them.
    noted = names.noted(GRAPH)
    assert noted[full] == "/active/tracks" and noted["/shipA/clock"] == "/clock"


def test_nodes_get_the_full_names_and_the_rules_that_make_them() -> None:
    names = graph_names(["active/tracks:=picture"], "shipA")
    node = PlannedNode("tracker", "m", subscriptions=(CONTACTS,), publishers=(ACTIVE_TRACKS,))
    (planned,) = names.planned([node])
    assert [topic.name for topic in planned.subscriptions] == ["/shipA/active/contacts"]
    assert [topic.name for topic in planned.publishers] == ["/shipA/picture"]
    assert planned.remaps == {"/shipA/active/tracks": "/shipA/picture"}


@pytest.mark.parametrize(
    ("remaps", "namespace", "sentence"),
    [
        (["active/contacts"], "", "give the name of a topic in the graph"),
        (["active/contacts:=/"], "", "give the name of a topic in the graph"),
        (["active/contacts:=/3d"], "", "'/3d' is no name in ROS"),
        (["active/contacts:=a//b"], "", "'a//b' is no name in ROS"),
        (["active/contacts:=a b"], "", "'a b' is no name in ROS"),
        (["active/contacts:=" + "a" * 300], "", "the name has 300 characters"),
        ([], "ship A", "--namespace: 'ship A' is no name in ROS"),
        ([], "1st", "--namespace: '1st' is no name in ROS"),
        (["active/contacts:=a", "/active/contacts:=b"], "", "/active/contacts is given twice"),
        (["active/contcts:=a"], "", "no topic /active/contcts; did you mean /active/contacts?"),
        (["active/contcts:=a"], "s", "no topic /s/active/contcts; did you mean /s/active/cont"),
        ([f"{BEARING_TRACKS.name}:=a"], "", "no topic /passive/bearing_tracks"),
        (["active/contacts:=a", "active/tracks:=/a"], "", "would both be called /a"),
        (["active/contacts:=active/tracks"], "", "would both be called /active/tracks"),
        (["active/contacts:=clock"], "s", "would both be called /s/clock"),
    ],
)
def test_what_cannot_be_done_is_refused(remaps: list[str], namespace: str, sentence: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        graph_names(remaps, namespace).check(GRAPH)
    assert sentence in str(caught.value)


def test_two_topics_may_change_their_names() -> None:
    names = graph_names(
        ["active/contacts:=active/tracks", "active/tracks:=active/contacts"], "shipA"
    )
    names.check(GRAPH)
    assert names.of(CONTACTS) == "/shipA/active/tracks"
    assert names.noted(GRAPH)["/shipA/active/tracks"] == "/active/contacts"
