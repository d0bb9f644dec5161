"""A process of a test that is a copy does what it would do if it had begun from nothing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.process_source import CopiedProcess

pytestmark = pytest.mark.slow


def test_it_says_and_returns_the_same(tmp_path: Path) -> None:
    variables = {**os.environ, "ROS_HOME": str(tmp_path), "COLUMNS": "70"}
    words = ["inspect", "nothing.csv"]
    whole = [sys.executable, "-m", "sonar_tracking", *words]
    done = subprocess.run(whole, env=variables, cwd=tmp_path, capture_output=True, text=True)
    copy = CopiedProcess("sonar_tracking", words, variables, tmp_path / "log", tmp_path)
    assert copy.wait(60.0) == done.returncode == 2
    assert (tmp_path / "log").read_text() == done.stdout + done.stderr


def test_it_is_a_child_of_the_process_of_the_tests_and_hears_its_signals(tmp_path: Path) -> None:
    log = tmp_path / "log"
    arguments = ["0", "--bind", "127.0.0.1"]
    server = CopiedProcess("http.server", arguments, os.environ, log)
    try:
        assert server.poll() is None
        status = Path(f"/proc/{server.pid}/stat").read_text().rpartition(")")[2].split()
        assert int(status[1]) == os.getpid()
        with pytest.raises(subprocess.TimeoutExpired):
            server.wait(0.1)
        server.send_signal(signal.SIGTERM)
        assert server.wait(60.0) == -signal.SIGTERM
    finally:
        server.kill()
