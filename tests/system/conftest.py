"""Recorded runs that several tests look at, each made once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.made_once import made_once
from tests.system.command_line import report_of, run_command

DURATION = 20.1
"""Of the recorded run, s: three crossings, half a second of processor time less each time it is
compared with something."""


@dataclass(frozen=True)
class RecordedRun:
    """The first half of doa_fusion at full speed, its bag, report and output."""

    bag: Path
    report: dict[str, Any]
    output: str


@pytest.fixture(scope="session")
def recorded_run(tmp_path_factory: pytest.TempPathFactory) -> RecordedRun:
    def make(folder: Path) -> None:
        done = run_command(
            folder,
            *("run", "doa_fusion", "--duration", DURATION, "--rate", "max"),
            *("--record", folder / "bag"),
            *("--json", folder / "report.json"),
        )
        assert done.returncode == 0, done.stdout
        (folder / "output.txt").write_text(done.stdout)

    folder = made_once(tmp_path_factory, "recorded_run", make)
    report = report_of(folder / "report.json")
    return RecordedRun(folder / "bag", report, (folder / "output.txt").read_text())
