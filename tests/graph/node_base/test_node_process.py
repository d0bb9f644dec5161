"""A node ends cleanly however it is asked to, and does not start with wrong parameters."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.graph.live_graph import Probe, node_process
from tests.ros_domain import ros_domain

pytestmark = pytest.mark.graph

MODULES = "sonar_tracking.graph.nodes."
NODE = "bearing_tracker"


@pytest.mark.parametrize("numbers", [[signal.SIGINT] * 3, [signal.SIGINT, signal.SIGTERM]])
def test_any_number_of_signals_ends_a_node_with_code_zero(
    tmp_path: Path, numbers: list[signal.Signals]
) -> None:
    """A terminal signals every process, and the orchestration forwards its own."""
    probe = Probe()
    with node_process(MODULES + NODE, tmp_path / "log", use_sim_time=True) as process:
        probe.wait(lambda: probe.matched(NODE), "node started")
        for number in numbers:
            process.send_signal(number)
            time.sleep(0.02)
        assert process.stop() == 0
        assert "Traceback" not in process.output
    probe.close()


@pytest.mark.parametrize(
    ("node", "parameters", "sentences"),
    [
        (
            "subspace_estimator",
            {"covariance_snapshots": -5, "forgeting_factor": 0.9},
            (
                "subspace_estimator.covariance_snapshots is -5; it must be at least 0.",
                "subspace_estimator.forgeting_factor is not known; did you mean forgetting_factor?",
            ),
        ),
        ("bearing_tracker", {"start": "given"}, ("initial_bearings_deg is empty",)),
        ("hpda_tracker", {"termination_probability": 0.95}, ("termination_probability is 0.95",)),
        (
            "line_tracker",
            {"qos_overrides./array/samples.subscription.depth": "x"},
            ("line_tracker: a qos_overrides parameter of array/samples cannot be used",),
        ),
        ("band_demodulator", {"use_sim_time": "perhaps"}, ("use_sim_time",)),
        ("recorder", {"ouput": "bag"}, ("recorder.ouput is not known; did you mean output?",)),
        ("recorder", {"output": "bag", "flow_depth": "x"}, ("flow_depth",)),
        ("bearing_tracker", {"start": "[1"}, ("ROS cannot read the arguments",)),
    ],
)
def test_wrong_parameters_are_said_and_end_a_node_with_code_one(
    tmp_path: Path, node: str, parameters: dict[str, object], sentences: tuple[str, ...]
) -> None:
    with node_process(MODULES + node, tmp_path / "log", **parameters) as process:
        assert process.wait() == 1
        assert all(sentence in process.output for sentence in sentences)
        assert "Traceback" not in process.output


HANGING = """
import sys, threading
from rclpy.node import Node
from sonar_tracking.graph.node_base import node_process

node_process.LEAVING_SECONDS = 0.5

class Hanging(Node):
    def destroy_node(self):
        threading.Event().wait()

node = []
def make_node():
    node.append(Hanging("hanging"))
    print("made", flush=True)
    return node[0]

sys.exit(node_process.run_node(make_node, lambda node: print("finished", flush=True)))
"""


def test_a_node_that_has_done_its_work_does_not_hang_in_the_middleware(tmp_path: Path) -> None:
    """The system ends it: a library that waits for itself hears of no handler."""
    process = subprocess.Popen(
        [sys.executable, "-c", HANGING],
        env={**os.environ, "ROS_DOMAIN_ID": str(ros_domain()), "ROS_HOME": str(tmp_path)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "made\n"
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60.0)
    assert said == "finished\n"
    assert process.returncode == -signal.SIGALRM
