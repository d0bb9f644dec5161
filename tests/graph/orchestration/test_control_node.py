"""Protects a run from what others say in its domain: reports and failures are its own nodes'."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from sonar_tracking_msgs.msg import Contacts, Progress

from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.topics import CONTACTS, DIAGNOSTICS_TOPIC, PROGRESS_TOPIC
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
    edges = MatchedEdges({OWN: {}}, {OWN: {"/flow/done": ("orchestration",)}})
    with ControlNode(FlowLedger({}, {}), edges, observer, (OWN,), (OWN,), names) as control:
        control.publish_clock(0)
        yield probe, control
    probe.close()


def report(node: str, concern: str, level: bytes = DiagnosticStatus.WARN) -> DiagnosticArray:
    """Return what a node says."""
    status = DiagnosticStatus(
        name=f"{node}: {concern}", level=level, message=f"{node} is ill.", hardware_id=node
    )
    status.values = [KeyValue(key="/flow/done", value="1")]
    return DiagnosticArray(status=[status])


def take_all(control: ControlNode) -> None:
    """Let a control node handle what has come, all of it.

    Were less handled in a round than is said in it, the queue would overflow by as many messages
    in each round, and the one that is read would be the same of every round for ever.
    """
    for _ in range(50):
        control.spin_once(0.002)


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
        take_all(control)
        return bool(control.notices and control.errors) and control.served is not None

    probe.wait(heard, "own node")
    for _ in range(50):
        control.spin_once(0.01)
    assert list(control.notices) == [f"{own}: input"]
    assert list(control.errors) == [f"{own}: {UNEXPECTED}"]
    assert control.served == 0


def test_what_does_not_bear_the_identity_of_the_run_is_not_believed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Under the right name, and with values that are no counts: neither counts nor ends the run."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(ros_domain()))
    probe = Probe()
    observer: Any = None
    edges = MatchedEdges({OWN: {}}, {OWN: {"/flow/done": ("orchestration",)}})
    ledger = FlowLedger({"/active/contacts": ("tracker",)}, {"/active/contacts": OWN})
    reports = probe.node.create_publisher(
        DiagnosticArray, DIAGNOSTICS_TOPIC, quality_of_service.DIAGNOSTICS
    )
    progress = probe.node.create_publisher(
        Progress, f"/{PROGRESS_TOPIC}", quality_of_service.PROGRESS
    )
    with ControlNode(
        ledger, edges, observer, (OWN, "tracker"), (OWN,), run="0123456789abcdef"
    ) as control:
        control.publish_clock(10**9)

        def heard() -> bool:
            for node, count in ((OWN, 2**40), ("tracker@0", 2**40), (f"{OWN}@1", 2**40)):
                for topic in ("/clock", "/active/contacts"):
                    progress.publish(Progress(node=node, topic=topic, count=count))
            late = Progress(node=f"{OWN}@0123456789abcdef", topic="/clock", count=1)
            late.header.stamp.sec = 99
            progress.publish(late)
            reports.publish(report(OWN, UNEXPECTED))
            believed = report(OWN, "matched", DiagnosticStatus.OK)
            believed.status[0].hardware_id = f"{OWN}@0123456789abcdef"
            believed.status[0].values.append(KeyValue(key="motor", value="left"))
            reports.publish(believed)
            take_all(control)
            return edges.missing([OWN]) == [f"{OWN} has not found orchestration on /flow/done"]

        probe.wait(heard, "the report that is believed")
        for _ in range(50):
            control.spin_once(0.01)
        assert control.served is None, "nobody has served an instant that was never told"
        assert ledger.published_messages("/active/contacts") == 0
        assert control.errors == {}
    probe.close()


def test_who_else_publishes_the_clock_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(ros_domain()))
    probe = Probe()
    observer: Any = None
    with ControlNode(FlowLedger({}, {}), MatchedEdges({}, {}), observer, ()) as control:
        full_name = probe.node.get_fully_qualified_name()
        probe.wait(lambda: full_name in control.other_clocks(), "the other clock")
    probe.close()


class _Careless:
    """An observer that can read nothing of what it gets."""

    def observed(self, topic: str, data: bytes, wall: float) -> None:
        raise OverflowError(f"{topic} is beyond\x1b[31m all measure")


def test_a_message_that_cannot_be_read_is_left_out_of_the_figures(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Anybody may publish on a topic of the run: whatever it is, the run goes on."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(ros_domain()))
    probe = Probe()
    observer: Any = _Careless()
    contacts = probe.node.create_publisher(Contacts, "/active/contacts", 10)
    with ControlNode(FlowLedger({}, {}), MatchedEdges({}, {}), observer, ()) as control:
        control.observe([CONTACTS])

        def noticed() -> bool:
            contacts.publish(Contacts())
            take_all(control)
            return bool(control.notices)

        probe.wait(noticed, "the notice")
        (sentence,) = control.notices.values()
        assert sentence.startswith("/active/contacts: a message is left out of the figures")
        assert "beyond" in sentence and "\x1b" not in sentence
    probe.close()
