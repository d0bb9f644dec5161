"""Data wait until every connection is there; a stranger on a topic is noticed."""

from sonar_tracking.graph.orchestration.matched_edges import MatchedEdges

EDGES = {"tracker": {"/clock": 1, "/array/subspaces": 1}}
OUTPUTS = {"tracker": {"/passive/bearing_tracks": 2}}


def test_everything_has_to_be_matched() -> None:
    edges = MatchedEdges(EDGES, OUTPUTS)
    assert edges.missing() == ["tracker has not reported"]
    edges.report("tracker", {"/clock": 1, "/array/subspaces": 1, "/passive/bearing_tracks": 1})
    assert edges.missing() == ["tracker has 1 of 2 connections on /passive/bearing_tracks"]
    edges.report("tracker", {"/clock": 1, "/array/subspaces": 1, "/passive/bearing_tracks": 3})
    assert edges.missing() == []
    edges.forget("tracker")
    assert edges.missing(["tracker"]) == ["tracker has not reported"]
    assert edges.missing([]) == []


def test_a_second_publisher_is_named_but_a_second_reader_is_welcome() -> None:
    edges = MatchedEdges(EDGES, OUTPUTS)
    edges.report("tracker", {"/clock": 2, "/array/subspaces": 1, "/passive/bearing_tracks": 9})
    assert edges.foreign_publishers() == ["/clock"]


def test_who_only_shows_a_topic_does_not_pass_for_one_who_has_to_hear_it() -> None:
    """Else data would flow before the tracker hears them, and the run would wait for those lost."""
    shown = {"display": {"/array/subspaces": 1, "/passive/bearing_tracks": 1}}
    edges = MatchedEdges(EDGES | shown, OUTPUTS, ["display"])
    edges.report("tracker", {"/clock": 1, "/array/subspaces": 1, "/passive/bearing_tracks": 2})
    assert edges.missing(["tracker"]) == []
    edges.report("display", {"/array/subspaces": 1, "/passive/bearing_tracks": 1, "/tf": 1})
    assert edges.visitors("/passive/bearing_tracks") == 1
    assert edges.missing(["tracker"]) == [
        "tracker has 2 of 3 connections on /passive/bearing_tracks"
    ]
    assert edges.visitors("/tf") == 0, "what it publishes itself it does not hear"
    edges.forget("display")
    assert edges.missing(["tracker"]) == []
