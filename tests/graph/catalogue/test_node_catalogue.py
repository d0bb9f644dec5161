"""The catalogue must be true, and readable where ROS is absent."""

from __future__ import annotations

import importlib
import subprocess
import sys

import pytest

from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import SNAPSHOTS
from sonar_tracking.graph.message_writing.field_writing import message_class

nodes = pytest.mark.parametrize("node", NODES.values(), ids=lambda node: node.name)


@pytest.mark.slow
def test_it_is_read_without_ros() -> None:
    code = (
        "import sys; from sonar_tracking.graph.catalogue.node_catalogue import NODES; "
        "assert all(node.parameters for node in NODES.values()); "
        "assert 'rclpy' not in sys.modules and 'sonar_tracking_msgs' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@nodes
def test_every_node_can_be_run(node: NodeDescription) -> None:
    assert callable(importlib.import_module(node.module).main)


@nodes
def test_every_topic_has_a_type(node: NodeDescription) -> None:
    for topic in (*node.inputs, *node.outputs):
        assert message_class(topic.message_type).__name__ == topic.message_type.rpartition("/")[2]


def test_every_input_comes_from_one_node() -> None:
    """Sources that publish the same, e.g. own ship, are never in one graph."""
    sources = [node for node in NODES.values() if node.section or node.is_live]
    trackers = [node for node in NODES.values() if node not in sources]
    computed = [topic for node in trackers for topic in node.outputs]
    assert len(set(computed)) == len(computed)
    simulated = {topic for node in sources for topic in node.outputs}
    # Snapshots are simulated, or taken out of samples that are: a scenario has one or the other.
    assert simulated & set(computed) == {SNAPSHOTS}
    for node in NODES.values():
        assert {*node.inputs, *node.optional_inputs} <= simulated | set(computed)
