"""Data wait until everybody has found everybody; a stranger on a topic is noticed."""

from sonar_tracking.graph.orchestration.matched_edges import MatchedEdges

TRACKS, SUBSPACES = "/passive/bearing_tracks", "/array/subspaces"
EDGES = {"tracker": {"/clock": ("orchestration",), SUBSPACES: ("estimator",)}}
OUTPUTS: dict[str, dict[str, tuple[str, ...]]] = {
    "tracker": {TRACKS: ("recorder", "orchestration")},
    "estimator": {SUBSPACES: ("tracker",)},
}
FOUND = {
    ("/clock", "orchestration"): 1,
    (SUBSPACES, "estimator"): 1,
    (TRACKS, "recorder"): 1,
    (TRACKS, "orchestration"): 1,
}
MATCHED = {"/clock": 1, SUBSPACES: 1, TRACKS: 2}


def connected() -> MatchedEdges:
    """Return a graph that is connected."""
    edges = MatchedEdges(EDGES, OUTPUTS)
    edges.report("tracker", MATCHED)
    edges.report_found("tracker", FOUND)
    edges.report("estimator", {SUBSPACES: 1})
    edges.report_found("estimator", {(SUBSPACES, "tracker"): 1})
    return edges


def test_everything_has_to_be_matched() -> None:
    edges = connected()
    assert edges.missing() == []
    edges.report("tracker", MATCHED | {TRACKS: 1})
    assert edges.missing() == ["tracker has 1 of 2 connections on /passive/bearing_tracks"]
    assert edges.missing([]) == []


def test_a_stranger_does_not_pass_for_one_who_has_to_hear() -> None:
    edges = connected()
    edges.report_found("tracker", {**FOUND, (TRACKS, "recorder"): 0, (TRACKS, "rviz"): 1})
    assert edges.missing() == ["tracker has not found recorder on /passive/bearing_tracks"]


def test_after_a_restart_both_ends_have_to_find_the_new_process() -> None:
    """The old one, which nobody has said goodbye for, is still counted."""
    edges = connected()
    edges.forget("tracker")
    assert set(edges.missing(["tracker"])) == {
        "tracker has not reported",
        "estimator has not found tracker on /array/subspaces",
    }
    edges.report("tracker", MATCHED)
    edges.report_found("tracker", FOUND)
    edges.report("estimator", {SUBSPACES: 2})
    assert edges.missing(["tracker"]) == ["estimator has not found tracker on /array/subspaces"]
    edges.report_found("estimator", {(SUBSPACES, "tracker"): 2})
    assert edges.missing(["tracker"]) == []


def test_where_both_ends_were_restarted_neither_waits_for_the_dead() -> None:
    edges = connected()
    edges.forget("tracker")
    edges.forget("estimator")
    edges.report("tracker", MATCHED)
    edges.report_found("tracker", FOUND)
    edges.report("estimator", {SUBSPACES: 1})
    edges.report_found("estimator", {(SUBSPACES, "tracker"): 1})
    assert edges.missing(["tracker", "estimator"]) == []


def test_a_second_publisher_is_named_but_a_second_reader_is_welcome() -> None:
    edges = connected()
    edges.report("tracker", {"/clock": 2, SUBSPACES: 1, TRACKS: 9})
    assert edges.foreign_publishers() == ["/clock"]


def test_a_display_is_found_by_those_it_hears() -> None:
    """It is not waited for before it says so, nor after it has ended."""
    shown = {"display": {TRACKS: ("tracker",)}}
    edges = MatchedEdges(EDGES | shown, OUTPUTS, ["display"])
    edges.report("tracker", MATCHED)
    edges.report_found("tracker", FOUND)
    estimator = "estimator has not found tracker on /array/subspaces"
    assert edges.missing(["tracker"]) == [estimator]
    edges.report("display", {TRACKS: 1})
    edges.report_found("display", {(TRACKS, "tracker"): 1})
    assert edges.missing(["tracker"]) == [
        estimator,
        "tracker has 2 of 3 connections on /passive/bearing_tracks",
    ]
    edges.forget("display")
    assert edges.missing(["tracker"]) == [estimator]
