"""A discovery server that does not answer is named while the nodes still look for each other."""

import signal
import socket
import subprocess
from pathlib import Path

import pytest

from tests.system.command_line import PATIENCE, command_of, environment

pytestmark = pytest.mark.system


def test_a_server_behind_a_firewall_is_named_before_the_run_is_given_up(tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as swallowing:
        swallowing.bind(("127.0.0.1", 0))
        server = f"127.0.0.1:{swallowing.getsockname()[1]}"
        process = subprocess.Popen(
            command_of("run", "active", "--no-display", pictures=False),
            env={**environment(tmp_path), "ROS_DISCOVERY_SERVER": server},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert process.stdout is not None
        said: list[str] = []
        while not any("do not find each other" in line for line in said):
            line = process.stdout.readline()
            assert line, f"it ended: {said}"
            said.append(line)
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=PATIENCE)
    assert server in said[-1] and "firewall" in said[-1]
    assert process.returncode == 130
    assert "Traceback" not in rest
