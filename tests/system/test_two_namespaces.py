"""Two graphs at once, each in its namespace, as the launch file describes their processes."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest

from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.topics import ACTIVE_TRACKS, TRANSFORMS, Topic
from tests.process_source import CopiedProcess
from tests.ros_domain import ros_domain
from tests.system.launch_stand_ins import launched_nodes

pytest.importorskip("rclpy")

from tests.graph.live_graph import Probe

pytestmark = pytest.mark.graph

SCENARIO = """
duration: 1000.0
active_sonar: {ping_interval: 1.0, maximum_range: 700.0, false_alarm_probability: 0.0001}
targets:
  - motion: {kind: kinematic, position: [0.0, 400.0], course_deg: 90.0, speed: 2.0}
"""


@contextmanager
def process(node: Any, log: Path) -> Iterator[None]:
    """Start a process as launch_ros does: arguments for name, namespace, topics, parameters."""
    given = node.keywords
    arguments = ["-r", f"__node:={given['name']}", "-r", f"__ns:=/{given['namespace']}"]
    for old, new in given["remappings"]:
        arguments += ["-r", f"{old}:={new}"]
    for values in given["parameters"]:
        for name, value in values.items():
            arguments += ["-p", f"{name}:={json.dumps(value)}"]
    module = NODES[given["executable"]].module
    variables = {**os.environ, **given["additional_env"], "ROS_DOMAIN_ID": str(ros_domain())}
    started = CopiedProcess(module, ["--ros-args", *arguments], variables, log)
    try:
        yield
    finally:
        started.send_signal(signal.SIGTERM)
        assert started.wait(60.0) == 0, log.read_text()


def named(name: str) -> Topic:
    """Return the list of tracks by another name."""
    return Topic(name, ACTIVE_TRACKS.message_type, ACTIVE_TRACKS.kind, ACTIVE_TRACKS.role, "")


def children(messages: list[Any]) -> set[str]:
    """Return the frames whose pose in ``map`` has been heard."""
    told = [transform for message in messages for transform in message.transforms]
    assert all(transform.header.frame_id == "map" for transform in told)
    return {transform.child_frame_id for transform in told}


def test_two_graphs_run_side_by_side_and_do_not_hear_each_other(tmp_path: Path) -> None:
    scenario = tmp_path / "one_ship.yaml"
    scenario.write_text(SCENARIO)
    first = launched_nodes("pipeline", scenario=str(scenario), namespace="ship_a")
    second = launched_nodes(
        "pipeline",
        scenario=str(scenario),
        namespace="ship_b",
        remap="active/tracks:=picture",
        hpda_tracker_method="hpda_kalman",
    )
    probe = Probe()
    here, there, nowhere, stray = (
        probe.listen(named(name))
        for name in ("ship_a/active/tracks", "ship_b/picture", "active/tracks", "picture")
    )
    transforms = probe.listen(TRANSFORMS)
    with ExitStack() as stack:
        for node in (*first.values(), *second.values()):
            log = tmp_path / f"{node.keywords['namespace']}_{node.keywords['name']}.log"
            stack.enter_context(process(node, log))
        probe.wait(lambda: len(here) >= 3 and len(there) >= 3, "tracks of both ships")
        ships = {f"{ship}/own_ship/base_link" for ship in ("ship_a", "ship_b")}
        probe.wait(
            lambda: children(transforms) >= ships,
            lambda: f"frames of both ships in one tree, but of {sorted(children(transforms))}",
        )
        # A sonar heard before its ship's odometry was found is in the map until it is aboard.
        assert children(transforms) <= ships | {"ship_a/sonar", "ship_b/sonar"}
        for ship in ("ship_a", "ship_b"):
            (publisher,) = probe.node.get_publishers_info_by_topic(f"/{ship}/active/contacts")
            readers = probe.node.get_subscriptions_info_by_topic(f"/{ship}/active/contacts")
            assert {reader.node_name for reader in readers} == {"hpda_tracker", "scene_publisher"}
            for endpoint in (publisher, *readers):
                assert endpoint.node_namespace == f"/{ship}"
    assert not nowhere and not stray
    probe.close()
