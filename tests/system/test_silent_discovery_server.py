"""A discovery server that does not answer is named while the nodes still look for each other."""

import socket
from pathlib import Path

import pytest

from tests.system.command_line import RunningCommand

pytestmark = pytest.mark.system


def test_a_server_behind_a_firewall_is_named_before_the_run_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as swallowing:
        swallowing.bind(("127.0.0.1", 0))
        server = f"127.0.0.1:{swallowing.getsockname()[1]}"
        monkeypatch.setenv("ROS_DISCOVERY_SERVER", server)
        command = RunningCommand(tmp_path, "run", "active", "--no-display")
        try:
            command.wait_for_text("do not find each other")
            command.interrupt()
            assert command.wait() == 130
        finally:
            command.clean_up()
    lines = command.output.splitlines()
    said = next(line for line in lines if "do not find each other" in line)
    assert server in said and "firewall" in said
    assert "Traceback" not in command.output
