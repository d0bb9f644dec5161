"""Recorded runs that several tests look at, each made once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.made_once import made_once
from tests.system.command_line import report_of, run_command

DURATION = 14.1
"""Of the recorded run, s: two crossings, and half a second of processor time less than with all
each time it is compared with something."""

ACTIVE_DURATION = 400.0
"""Of that with a sonar, s: forty pings."""


@dataclass(frozen=True)
class RecordedRun:
    """Bag, report and output of a run."""

    bag: Path
    report: dict[str, Any]
    output: str


@pytest.fixture(scope="session")
def recorded_run(tmp_path_factory: pytest.TempPathFactory) -> RecordedRun:
    """Record the first third of ``doa_fusion`` at full speed."""
    return _recorded(tmp_path_factory, "doa_fusion", DURATION)


@pytest.fixture(scope="session")
def active_run(tmp_path_factory: pytest.TempPathFactory) -> RecordedRun:
    """Record the first third of ``active`` at full speed, without what is shown of it."""
    return _recorded(tmp_path_factory, "active", ACTIVE_DURATION)


def _recorded(factory: pytest.TempPathFactory, scenario: str, duration: float) -> RecordedRun:
    def make(folder: Path) -> None:
        done = run_command(
            folder,
            *("run", scenario, "--duration", duration, "--rate", "max"),
            *("--record", folder / "bag", "--json", folder / "report.json"),
        )
        assert done.returncode == 0, done.stdout
        (folder / "output.txt").write_text(done.stdout)

    folder = made_once(factory, f"recorded_{scenario}", make)
    report = report_of(folder / "report.json")
    return RecordedRun(folder / "bag", report, (folder / "output.txt").read_text())
