"""Protects the end of the tests: one that takes its process down fails, and the others are run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

CRASHES = """
import os

def test_one():
    pass

def test_that_crashes():
    if not os.path.exists("crashed"):
        open("crashed", "w").close()
        os._exit(3)

def test_two():
    pass
"""
PASSES = "import time\n\ndef test_alone():\n    time.sleep(0.4)\n"


@pytest.mark.slow
def test_a_worker_that_is_gone_costs_one_test(tmp_path: Path) -> None:
    """Files of one test each are what a new worker would wait at."""
    for number in range(20):
        text = CRASHES if number == 5 else PASSES
        (tmp_path / f"test_{number:02}.py").write_text(text)
    done = subprocess.run(
        [
            *(sys.executable, "-m", "pytest", "-p", "xdist", "-n", "2"),
            *("-p", "tests.sharing_out", "--rootdir=."),
        ],
        cwd=tmp_path,
        env={"PYTHONPATH": str(Path(__file__).parents[1]), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=100.0,
    )
    assert done.returncode == 1, done.stdout + done.stderr
    assert "crashed while running 'test_05.py::test_that_crashes'" in done.stdout
    assert "has ended with 3" in done.stdout
    assert "1 failed, 22 passed" in done.stdout
