"""A node ends cleanly however it is asked to, and starts whatever it is told."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest

from tests.graph.live_graph import Probe, node_process

pytestmark = pytest.mark.graph

NODE = "bearing_tracker"


@pytest.mark.parametrize("numbers", [[signal.SIGINT] * 3, [signal.SIGINT, signal.SIGTERM]])
def test_any_number_of_signals_ends_a_node_with_code_zero(
    tmp_path: Path, numbers: list[signal.Signals]
) -> None:
    """A terminal signals every process, and the orchestration forwards its own."""
    probe = Probe()
    parameters = {"start": "given", "use_sim_time": True}
    with node_process(
        f"sonar_tracking.graph.nodes.{NODE}", tmp_path / "log", **parameters
    ) as process:
        probe.wait_sentence(f"{NODE}: parameters", "initial_bearings_deg is empty", "The defaults")
        assert process.is_alive
        for number in numbers:
            process.send_signal(number)
            time.sleep(0.02)
        assert process.stop() == 0
        assert "Traceback" not in process.output
        assert "initial_bearings_deg is empty" in process.output
    probe.close()
