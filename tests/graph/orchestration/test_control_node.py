"""Protects a run from what others say in its domain: reports and failures are its own nodes'."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.topics import DIAGNOSTICS_TOPIC, PROGRESS_TOPIC
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.diagnostics import UNEXPECTED
from sonar_tracking.graph.orchestration.control_node import ControlNode
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.matched_edges import MatchedEdges
from tests.graph.live_graph import Probe
from tests.ros_domain import ros_domain

pytestmark = pytest.mark.graph

OWN = "contact_simulator"
STRANGERS = ("camera", "ship_b/contact_simulator", "hpda_tracker")
SHIP = GraphNames("/ship_b")


@pytest.fixture(params=[ROOT_NAMES, SHIP], ids=["root", "namespace"])
def names(request: pytest.FixtureRequest) -> GraphNames:
    """Return the names of the run: the other one is a stranger's."""
    given: GraphNames = request.param
    return given


@pytest.fixture
def graph(
    names: GraphNames, monkeypatch: pytest.MonkeyPatch
) -> Iterator[tuple[Probe, ControlNode]]:
    """Start a run of one node, and somebody else in its domain."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(ros_domain()))
    probe = Probe()
    observer: Any = None
    edges = MatchedEdges({OWN: {}}, {OWN: {"/flow/done": 1}})
    with ControlNode(FlowLedger({}, {}), edges, observer, (OWN,), (OWN,), names) as control:
        yield probe, control
    probe.close()


def report(node: str, concern: str, level: bytes = DiagnosticStatus.WARN) -> DiagnosticArray:
    """Return what a node says."""
    status = DiagnosticStatus(name=f"{node}: {concern}", level=level, message=f"{node} is ill.")
    status.values = [KeyValue(key="/flow/done", value="1")]
    return DiagnosticArray(status=[status])


def test_only_nodes_of_the_run_are_heard(
    graph: tuple[Probe, ControlNode], names: GraphNames
) -> None:
    probe, control = graph
    own = names.of_node(OWN).lstrip("/")
    others = {*STRANGERS, OWN} - {own}
    reports = probe.node.create_publisher(
        DiagnosticArray, DIAGNOSTICS_TOPIC, quality_of_service.DIAGNOSTICS
    )
    progress, stray = (
        probe.node.create_publisher(Progress, topic, quality_of_service.PROGRESS)
        for topic in (names.of(PROGRESS_TOPIC), f"/ship_c/{PROGRESS_TOPIC}")
    )

    def heard() -> bool:
        """Say everything again: who has just come may miss the first of it."""
        for node in (*others, own):
            for concern in ("input", UNEXPECTED):
                reports.publish(report(node, concern))
            reports.publish(report(node, "matched", DiagnosticStatus.OK))
            name = node.rpartition("/")[2]
            progress.publish(Progress(node=name, topic="/clock", count=1))
            late = Progress(node=name, topic="/clock", count=1)
            late.header.stamp.sec = 99
            stray.publish(late)
        control.spin_once(0.05)
        return bool(control.notices and control.errors) and control.served is not None

    probe.wait(heard, "own node")
    for _ in range(50):
        control.spin_once(0.01)
    assert list(control.notices) == [f"{own}: input"]
    assert list(control.errors) == [f"{own}: {UNEXPECTED}"]
    assert control.served == 0
