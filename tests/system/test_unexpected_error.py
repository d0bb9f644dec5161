"""An error of the program itself must not pass for a good run."""

from pathlib import Path

import pytest

from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from tests.system.command_line import report_of, run_command

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
    done = run_command(
        tmp_path, "run", "doa_fusion", "--duration", "4", "--rate", "max", "--json", json
    )
    assert done.returncode == 1, done.stdout
    report = report_of(json)
    assert any("ZeroDivisionError" in sentence for sentence in report["failures"])
    # The node lives and answers each estimate all the same.
    assert report["nodes"]["bearing_tracker"]["messages_out"] == 4
    assert report["nodes"]["bearing_tracker"]["restarts"] == 0
