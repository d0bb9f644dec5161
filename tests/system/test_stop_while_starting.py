"""Ctrl-C and SIGTERM are in order at every instant of a start: no traceback.

A node ends with exit code 0, a command with 128 and the number of the signal.

The instants are told by what the process shows of itself, not by the clock.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from sonar_tracking.graph.catalogue.node_catalogue import NODES
from tests.system.command_line import PATIENCE, environment

NODE_MODULES = [*(node.module for node in NODES.values()), "sonar_tracking.graph.nodes.recorder"]
FEW_NODES = ("run", "active", "--no-display", "--no-display-topics")
"""What the command is at does not depend on how many nodes it starts."""
COMMAND = [sys.executable, "-m", "sonar_tracking", *FEW_NODES]
STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)

Instant = Callable[[int], bool]


def handles_stop_signals(process: int) -> bool:
    """Tell whether a process has come to our code: Python alone does not handle SIGTERM."""
    status = (Path("/proc") / str(process) / "status").read_text()
    (caught,) = [line.split()[1] for line in status.splitlines() if line.startswith("SigCgt")]
    return bool(int(caught, 16) >> (signal.SIGTERM - 1) & 1)


def has_loaded(library: str) -> Instant:
    """Return the instant from which on a process has a library loaded."""
    return lambda process: library in (Path("/proc") / str(process) / "maps").read_text()


def has_started_nodes(process: int) -> bool:
    """Tell whether a command has started the first of its nodes."""
    return bool((Path("/proc") / str(process) / "task" / str(process) / "children").read_text())


INSTANTS = [
    pytest.param(handles_stop_signals, id="first line"),
    pytest.param(has_loaded("_multiarray_umath"), id="import of numpy"),
    pytest.param(has_loaded("_rclpy_pybind11"), id="import of rclpy"),
]
FIRST_NODE = pytest.param(has_started_nodes, id="first node")


def outcome(
    command: list[str], home: Path, reached: Instant, number: signal.Signals
) -> tuple[int, str]:
    """Return exit code and output of a program that gets a signal at an instant of its start."""
    process = subprocess.Popen(
        command,
        env=environment(home),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        deadline = time.monotonic() + PATIENCE
        while not reached(process.pid):
            assert process.poll() is None and time.monotonic() < deadline
            time.sleep(0.001)
        process.send_signal(number)
        output, _ = process.communicate(timeout=PATIENCE)
        return process.returncode, output
    finally:
        process.kill()


@pytest.mark.parametrize("module", NODE_MODULES, ids=lambda module: module.rpartition(".")[2])
@pytest.mark.parametrize("number", STOP_SIGNALS)
def test_a_node_ends_from_its_first_line_on(
    module: str, number: signal.Signals, tmp_path: Path
) -> None:
    command = [sys.executable, "-m", module]
    assert outcome(command, tmp_path, handles_stop_signals, number) == (0, "")


@pytest.mark.parametrize("number", STOP_SIGNALS)
@pytest.mark.parametrize("reached", INSTANTS)
def test_an_executable_ends_during_its_imports(
    reached: Instant, number: signal.Signals, tmp_path: Path
) -> None:
    """As ``ros2 run`` starts it: a script of the name of the node."""
    script = tmp_path / "bearing_tracker"
    script.write_text(
        "import sys\n"
        "from sonar_tracking.graph.nodes.bearing_tracker import main\n"
        "sys.exit(main())\n"
    )
    assert outcome([sys.executable, str(script)], tmp_path, reached, number) == (0, "")


@pytest.mark.parametrize("number", STOP_SIGNALS)
@pytest.mark.parametrize("reached", [*INSTANTS, FIRST_NODE])
def test_a_run_ends_during_its_start(
    reached: Instant, number: signal.Signals, tmp_path: Path
) -> None:
    code, output = outcome(COMMAND, tmp_path, reached, number)
    assert code == 128 + number
    assert "Traceback" not in output and "Aborted" not in output


def test_a_program_that_imports_a_node_keeps_its_own_handlers() -> None:
    code = (
        "import signal; before = signal.getsignal(signal.SIGTERM); "
        "import sonar_tracking.graph.nodes; assert signal.getsignal(signal.SIGTERM) == before"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env=dict(os.environ))
