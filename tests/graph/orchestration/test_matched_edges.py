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
