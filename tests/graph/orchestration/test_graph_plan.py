"""The plan of a graph says who waits for whom, and how each node is started."""

from pathlib import Path

import yaml

from sonar_tracking.graph.catalogue.graph_names import GraphNames
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, SNAPSHOTS, SUBSPACES
from sonar_tracking.graph.catalogue.transport_profile import TransportChoice
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan, process_plan

ESTIMATOR = PlannedNode("estimator", "a.module", (SNAPSHOTS,), (SUBSPACES,), {"period": 1.0})
TRACKER = PlannedNode(
    "tracker",
    "another.module",
    (SUBSPACES,),
    (BEARING_TRACKS,),
    {"first_id": 1, "initial_bearings_deg": (), "initial_rates_deg": (0.5, -1.0)},
    gives_identifiers=True,
)
RECORDER = PlannedNode("recorder", "third.module", (SNAPSHOTS, SUBSPACES, BEARING_TRACKS))
REPLAY = GraphPlan("a_scenario", (ESTIMATOR, TRACKER, RECORDER), offered=(SNAPSHOTS,))


def test_the_orchestration_listens_to_everything_it_does_not_publish_itself() -> None:
    assert set(REPLAY.observed()) == {"/array/subspaces", "/passive/bearing_tracks"}
    assert REPLAY.producers()["/array/snapshots"] == CONTROL_NODE
    assert REPLAY.consumers() == {
        "/array/snapshots": ("estimator", "recorder"),
        "/array/subspaces": ("tracker", "recorder", CONTROL_NODE),
        "/passive/bearing_tracks": ("recorder", CONTROL_NODE),
    }


def test_every_connection_has_to_be_matched() -> None:
    edges = REPLAY.edges()
    for node in ("estimator", "recorder", "tracker"):
        edges.report(node, {})
    assert set(edges.missing(["tracker"])) == {
        "tracker has 0 of 1 connections on /clock",
        "tracker has 0 of 1 connections on /flow/done",
        "tracker has 0 of 1 connections on /array/subspaces",
        "tracker has 0 of 2 connections on /passive/bearing_tracks",
        "estimator has not found tracker on /array/subspaces",
        "recorder has not found tracker on /passive/bearing_tracks",
    }


def test_in_a_namespace_everything_is_below_it_but_what_is_transported_largely(
    tmp_path: Path,
) -> None:
    names = GraphNames("/shipA", {"/shipA/array/subspaces": "/shipA/spaces"})
    nodes = names.planned([ESTIMATOR, TRACKER])
    transport = TransportChoice(large_publishers={"PROFILE": "large"}, others={"PROFILE": "none"})
    plan = GraphPlan("a_scenario", nodes, transport=transport, naming=names)
    estimator, tracker = plan.nodes
    edges = plan.edges()
    edges.report("tracker", {})
    assert set(edges.missing(["tracker"])) == {
        "tracker has 0 of 1 connections on /shipA/clock",
        "tracker has 0 of 1 connections on /shipA/flow/done",
        "tracker has 0 of 1 connections on /shipA/spaces",
        "tracker has 0 of 1 connections on /shipA/passive/bearing_tracks",
        "estimator has not found tracker on /shipA/spaces",
    }
    process = plan.process(tracker, tmp_path)
    rules = {"__ns:=/shipA", "/clock:=/shipA/clock", "/shipA/array/subspaces:=/shipA/spaces"}
    assert rules == set(process.arguments) - {"--ros-args", "-r"} - set(process.arguments[-2:])
    parameters = yaml.safe_load((tmp_path / "tracker.yaml").read_text())
    assert list(parameters) == ["/shipA/tracker"]
    assert plan.process(estimator, tmp_path).environment["PROFILE"] == "large"


def test_a_parameter_file_holds_what_ros_can_read(tmp_path: Path) -> None:
    transport = TransportChoice(large_publishers={"PROFILE": "large"}, others={"PROFILE": "none"})
    plan = process_plan(TRACKER, transport, tmp_path)
    assert plan.arguments == ("--ros-args", "--params-file", str(tmp_path / "tracker.yaml"))
    parameters = yaml.safe_load((tmp_path / "tracker.yaml").read_text())
    assert parameters == {
        "tracker": {
            "ros__parameters": {
                "first_id": 1,
                "initial_rates_deg": [0.5, -1.0],
                "use_sim_time": True,
            }
        }
    }
    assert plan.environment["PROFILE"] == "none"
    assert plan.environment["OPENBLAS_NUM_THREADS"] == "1"
    assert process_plan(ESTIMATOR, transport, tmp_path).environment["PROFILE"] == "large"


def test_identifiers_begin_anew_after_a_restart(tmp_path: Path) -> None:
    process_plan(TRACKER, TransportChoice(), tmp_path, restarts=2)
    parameters = yaml.safe_load((tmp_path / "tracker.yaml").read_text())
    assert parameters["tracker"]["ros__parameters"]["first_id"] == (2 << 32) + 1
