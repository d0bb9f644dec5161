"""One recorded run that several tests look at."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.system.command_line import report_of, run_command


@dataclass(frozen=True)
class RecordedRun:
    """A run of the default scenario at full speed, its bag, report and output."""

    bag: Path
    report: dict[str, Any]
    output: str


@pytest.fixture(scope="session")
def recorded_run(tmp_path_factory: pytest.TempPathFactory) -> RecordedRun:
    folder = tmp_path_factory.mktemp("recorded_run")
    done = run_command(
        folder,
        *("run", "doa_fusion", "--rate", "max", "--record", folder / "bag"),
        *("--json", folder / "report.json"),
    )
    assert done.returncode == 0, done.stdout
    return RecordedRun(folder / "bag", report_of(folder / "report.json"), done.stdout)
