"""Whoever starts a graph hears of every connection at once; a node warms up between it and data."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from sonar_tracking.graph.node_base.ready_reports import (
    LOOKS_PER_REPORT,
    PATIENCE_LOOKS,
    ReadyReports,
)


class Scene:
    """A node whose timer is driven by hand."""

    def __init__(self) -> None:
        self.connections: dict[str, object] = {"/a": 0, "/clock": 0}
        self.data_flow = False
        self.published = self.warmed = self.asked = 0
        self.publishers: list[Any] = []
        ReadyReports(
            self,  # type: ignore[arg-type]
            SimpleNamespace(publish=self._publish, add=lambda concern, values: None),  # type: ignore[arg-type]
            lambda: self.connections,
            lambda: self.data_flow,
            self._warm_up,
        )

    def create_timer(self, _period: float, look: Callable[[], None], clock: object) -> Any:
        self.look = look
        return None

    def get_publishers_info_by_topic(self, _topic: str) -> list[Any]:
        self.asked += 1
        return []

    def _publish(self) -> None:
        self.published += 1

    def _warm_up(self) -> None:
        assert self.published
        self.warmed += 1


@pytest.fixture
def scene() -> Scene:
    scene = Scene()
    scene.publishers.append(
        SimpleNamespace(topic_name="/diagnostics", get_subscription_count=lambda: 1)
    )
    return scene


def test_every_new_connection_is_reported_at_once(scene: Scene) -> None:
    scene.look()
    assert scene.published == 1
    scene.look()
    assert scene.published == 1
    scene.connections = {"/a": 1, "/clock": 0}
    scene.look()
    assert scene.published == 2


def test_a_report_is_repeated_for_late_listeners(scene: Scene) -> None:
    for _ in range(2 * LOOKS_PER_REPORT):
        scene.look()
    assert scene.published == 2


def test_a_connected_node_warms_up_once(scene: Scene) -> None:
    scene.look()
    assert scene.warmed == 0
    scene.connections = {"/a": 1, "/clock": 1}
    for _ in range(5):
        scene.look()
    assert scene.warmed == 1


def test_a_node_does_not_wait_for_ever_for_an_input_that_may_not_come(scene: Scene) -> None:
    for _ in range(PATIENCE_LOOKS + 2):
        scene.look()
    assert scene.warmed == 1


def test_with_data_nothing_is_looked_up_until_connections_change(scene: Scene) -> None:
    scene.data_flow = True
    for _ in range(PATIENCE_LOOKS + 5):
        scene.look()
    asked, published = scene.asked, scene.published
    for _ in range(20):
        scene.look()
    assert (scene.asked, scene.published, scene.warmed) == (asked, published, 0)
    scene.connections = {"/a": 2, "/clock": 0}
    scene.look()
    assert scene.asked > asked
    assert scene.published == published + 1
