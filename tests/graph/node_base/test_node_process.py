"""A node ends cleanly however it is asked to, and does not start with wrong parameters."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest

from tests.graph.live_graph import Probe, node_process

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
