"""A run in which a node put out nothing has not gone well, whatever the exit codes say."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from sonar_tracking.graph.orchestration.reported_figures import silent_nodes
from sonar_tracking.graph.orchestration.run_report import NodeReport


def node(messages_in: int, messages_out: int) -> NodeReport:
    return NodeReport(0, 0, 1.0, messages_in, messages_out)


NODES = {
    "simulator": node(0, 400),
    "estimator": node(400, 80),
    "tracker": node(80, 0),
    "new_one": node(3, 0),
    "recorder": node(560, 0),
}
PLANNED: Any = {
    name: SimpleNamespace(publishers=() if name == "recorder" else ("topic",)) for name in NODES
}


def test_who_has_heard_enough_and_says_nothing_is_named() -> None:
    (sentence,) = silent_nodes(NODES, PLANNED, 40.0)
    assert sentence.startswith("tracker has received 80 messages and put out nothing")


def test_little_data_may_not_be_enough_for_an_output() -> None:
    assert silent_nodes(NODES, PLANNED, 2.0) == []


def test_who_has_rejected_everything_is_named_however_little_it_was() -> None:
    (sentence,) = silent_nodes(NODES, PLANNED, 2.0, {"new_one", "estimator"})
    assert sentence.startswith("new_one has rejected its whole input, 3 messages")
