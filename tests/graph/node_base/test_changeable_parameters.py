"""What can be changed while a node runs is taken between two data, or refused with a sentence."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.resources import find_resource
from tests.ros_domain import ros_domain

rclpy = pytest.importorskip("rclpy")

from rclpy.parameter import Parameter  # noqa: E402

from sonar_tracking.graph.node_base import parameters  # noqa: E402
from sonar_tracking.graph.nodes.bearing_tracker import BearingTracker  # noqa: E402
from sonar_tracking.graph.nodes.hpda_tracker import HpdaTracker  # noqa: E402
from sonar_tracking.graph.nodes.tma_tracker import TmaTracker  # noqa: E402

pytestmark = pytest.mark.graph

FILES = [find_resource(f"config/parameters/{name}.yaml") for name in NODES]


@pytest.fixture
def ros() -> Iterator[None]:
    """Start as ``--params-file`` would, in a namespace: every parameter at its default."""
    files = [word for file in FILES for word in ("--params-file", str(file))]
    arguments = ["--ros-args", "-r", "__ns:=/ship_a/sonar", *files]
    rclpy.init(args=arguments, domain_id=ros_domain())
    yield
    rclpy.shutdown()


def test_a_parameter_file_is_read_by_ros_whatever_the_namespace(ros: None) -> None:
    node = BearingTracker()
    known = {entry.name: entry.default for entry in NODES["bearing_tracker"].parameters}
    assert parameters.overrides_of(node).keys() == known.keys()
    assert node.get_parameter("method").value == known["method"]
    assert node.get_namespace() == "/ship_a/sonar"
    node.destroy_node()


def test_thresholds_change_together_or_not_at_all(ros: None) -> None:
    node = HpdaTracker()
    tracker = node._tracker
    before = tracker.configuration
    result = _set(node, termination_probability=0.95)
    assert not result.successful
    assert "termination_probability is 0.95" in result.reason
    assert tracker.configuration is before
    assert _set(node, termination_probability=0.95, confirmation_probability=0.99).successful
    assert node._tracker is tracker
    assert tracker.configuration.termination_probability == 0.95
    assert node.get_parameter("confirmation_probability").value == 0.99
    node.reset()
    assert node._tracker.configuration.confirmation_probability == 0.99
    node.destroy_node()


def test_what_is_made_once_cannot_be_changed(ros: None) -> None:
    node = HpdaTracker()
    for name, value in {"method": "hpda_kalman", "n_particles": 100, "mounting_x": 1.0}.items():
        result = _set(node, **{name: value})
        assert not result.successful and "read-only" in result.reason
    node.destroy_node()


@pytest.mark.parametrize(
    ("name", "make"), [("hpda_tracker", HpdaTracker), ("tma_tracker", TmaTracker)]
)
def test_every_changeable_parameter_reaches_the_stage(ros: None, name: str, make: Any) -> None:
    node = make()
    stage = node._tracker if name == "hpda_tracker" else node._stage
    changeable = [entry for entry in NODES[name].parameters if entry.changeable]
    assert changeable
    for entry in changeable:
        value = 0.95 * float(str(entry.default)) + 0.01
        assert _set(node, **{entry.name: value}).successful
        assert getattr(stage.configuration, entry.name) == value
    assert not _set(node, **{changeable[-1].name: float("nan")}).successful
    node.destroy_node()


def test_nodes_without_anybody_to_take_a_change_declare_nothing_changeable() -> None:
    changeable = {
        name for name, node in NODES.items() if any(e.changeable for e in node.parameters)
    }
    assert changeable == {"hpda_tracker", "tma_tracker", "scene_publisher"}


def _set(node: Any, **values: Any) -> Any:
    return node.set_parameters_atomically([Parameter(name, value=v) for name, v in values.items()])
