"""A reduced campaign: a run that is disturbed goes on, or ends as it should."""

from __future__ import annotations

from pathlib import Path

from tests.system.command_line import refused, report_of, run_command


def test_disturbed_runs_neither_stall_nor_leave_anything_behind(tmp_path: Path) -> None:
    figures = tmp_path / "chaos.json"
    done = run_command(
        tmp_path,
        *("chaos", "active", "--runs", 1, "--faults", "malformed"),
        *("--rate", 60, "--seed", 2, "--json", figures),
    )
    assert done.returncode == 0, done.stdout
    faults = report_of(figures)["faults"]
    assert {each["fault"]["kind"] for each in faults} == {"malformed"}
    for each in faults:
        assert not each["failed"], each
        assert each["tracks"]["kept"] == each["tracks"]["established"] > 0, each
    assert faults[0]["lost_messages"] == 0


def test_what_cannot_be_disturbed_is_refused(tmp_path: Path) -> None:
    assert "--faults" in refused(tmp_path, "chaos", "active", "--faults", "flood")
