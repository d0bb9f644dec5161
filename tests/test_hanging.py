"""Protects the end of the tests: one that hangs ends its process, and says where."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

WATCHED = """
from tests.hanging import Watch

def pytest_configure(config):
    config.pluginmanager.register(Watch(longest=0.5, anew=0.0))
"""
HANGS = "import time\n\ndef test_that_hangs():\n    time.sleep(90.0)\n"


@pytest.mark.slow
def test_a_test_that_hangs_ends_its_process(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text(WATCHED)
    (tmp_path / "test_it.py").write_text(HANGS)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "--rootdir=."],
        cwd=tmp_path,
        env={"PYTHONPATH": str(Path(__file__).parents[1])},
        capture_output=True,
        text=True,
        timeout=60.0,
    )
    assert done.returncode == 1, done.stdout + done.stderr
    assert "in test_that_hangs" in done.stderr
