"""An error of the program itself must not pass for a good run."""

import subprocess
import sys
from pathlib import Path

import pytest

from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from tests.system.command_line import PATIENCE, environment, report_of

BROKEN = f"""
import {BearingTrackerStage.__module__} as stage

def update(self, estimates):
    raise ZeroDivisionError("division by zero")

stage.BearingTrackerStage.update = update
"""


def test_a_run_with_an_unexpected_error_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sitecustomize.py").write_text(BROKEN)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=":")
    json = tmp_path / "report.json"
    words = ["run", "doa_fusion", "--duration", "4", "--rate", "max", "--json", str(json)]
    done = subprocess.run(
        [sys.executable, "-m", "sonar_tracking", *words],
        env=environment(tmp_path),
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert done.returncode == 1, done.stdout + done.stderr
    report = report_of(json)
    assert any("ZeroDivisionError" in sentence for sentence in report["failures"])
    # The node lives and answers each estimate all the same.
    assert report["nodes"]["bearing_tracker"]["messages_out"] == 4
    assert report["nodes"]["bearing_tracker"]["restarts"] == 0
