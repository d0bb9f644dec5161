"""Protects what a node says of silent inputs: of those that data wait for, by the clock it has."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from sonar_tracking.graph.catalogue.topics import CONTACTS, ODOMETRY
from sonar_tracking.graph.node_base import node_watch
from sonar_tracking.graph.node_base.diagnostics import Diagnostics
from sonar_tracking.graph.node_base.node_watch import NodeWatch
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

START = 1_800_000_000 * NANOSECONDS
PATIENCE = 30
"""Seconds of silence before an input is reported whose period is not known."""


class Watched:
    """A node with two silent inputs, and what it has said."""

    def __init__(self, by_clock_topic: bool, rate: int = 1) -> None:
        self.now = START
        self.rate = rate
        self.steady = 0
        self.waits_for_odometry = False
        self.released = 0
        self.said: list[str] = []
        self.timers: list[Callable[[], None]] = []
        self.inputs = [self._input("/active/contacts", CONTACTS)]
        self.inputs.append(self._input("/own_ship/odometry", ODOMETRY))
        logger = SimpleNamespace(error=self.said.append, warning=self.said.append)
        self.statuses: dict[str, str] = {}
        diagnostics = Diagnostics("tracker", logger, self._take)  # type: ignore[arg-type]
        node: Any = SimpleNamespace(
            get_parameter=lambda name: SimpleNamespace(value=by_clock_topic),
            get_clock=lambda: SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=self.now)),
            create_timer=self._create_timer,
            get_publishers_info_by_topic=lambda name: [],
            resolve_topic_name=lambda name: name,
            subscriptions=[],
            publishers=[],
        )
        flow: Any = SimpleNamespace(
            publisher=SimpleNamespace(topic_name="/flow/done", get_subscription_count=lambda: 1)
        )
        self.watch = NodeWatch(
            node,
            self.inputs,
            [],
            diagnostics,
            flow,
            lambda: None,
            lambda source: source.topic is CONTACTS or self.waits_for_odometry,
            self._release,
        )

    def after(self, seconds: int) -> None:
        """Let time pass, so many times faster than real time; the node looks every second."""
        steady: Any = SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=self.steady))
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self.watch, "_steady", steady)
            for _ in range(seconds):
                self.timers[-1]()
                self.now += NANOSECONDS
                self.steady += NANOSECONDS // self.rate

    @staticmethod
    def _input(name: str, topic: Any) -> Any:
        return SimpleNamespace(
            name=name,
            topic=topic,
            received=0,
            period=0,
            guard=SimpleNamespace(expected=0),
            subscription=SimpleNamespace(get_publisher_count=lambda: 1),
        )

    def _create_timer(self, period: float, callback: Callable[[], None], clock: Any = None) -> Any:
        self.timers.append(callback)

    def _take(self, message: Any) -> None:
        self.statuses = {status.name: status.message for status in message.status}

    def _release(self) -> None:
        self.released += 1


@pytest.mark.parametrize("by_clock_topic", [True, False])
def test_the_clock_is_named_where_it_drives_the_node(by_clock_topic: bool) -> None:
    node = Watched(by_clock_topic)
    node.after(PATIENCE + 1)
    assert not node.said
    node.after(1)
    (sentence,) = node.said
    assert "/active/contacts: nothing received for 31.0 s" in sentence
    assert ("/clock" in sentence) == by_clock_topic


def test_a_clock_that_races_ahead_makes_no_input_silent() -> None:
    """A minute within a second: whoever publishes may have been without a processor for that."""
    node = Watched(by_clock_topic=True, rate=100)
    node.after(3 * PATIENCE)
    assert not node.said
    node.after(PATIENCE)
    assert len(node.said) == 1, "but one that is silent for longer than that has stalled"


def test_odometry_may_be_silent_until_data_wait_for_it() -> None:
    """Messages that carry their pose need none."""
    node = Watched(by_clock_topic=False)
    status = "tracker: input /own_ship/odometry"
    node.after(2 * PATIENCE)
    assert node.statuses[status] == "ok"
    node.waits_for_odometry = True
    node.after(1)
    assert "nothing received for 60.0 s" in node.statuses[status]
    node.waits_for_odometry = False
    node.after(1)
    assert node.statuses[status] == "ok"


def test_an_input_that_comes_or_has_ended_is_not_silent() -> None:
    node = Watched(by_clock_topic=False)
    for received in range(5):
        node.inputs[0].received = received
        node.after(PATIENCE)
    node.inputs[0].guard.expected = END_OF_DATA
    node.after(10 * PATIENCE)
    assert not node.said


def test_what_waits_is_looked_after(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no clock is published a node that has just begun may not know all publishers."""
    node = Watched(by_clock_topic=False)
    node.after(2)
    assert node.released == 2
    assert node.watch.may_not_know_all()
    assert not Watched(by_clock_topic=True).watch.may_not_know_all()
    monkeypatch.setattr(node_watch, "DISCOVERY", 0)
    assert not node.watch.may_not_know_all()
