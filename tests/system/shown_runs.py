"""Runs that are recorded with what is shown of them, each made once."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from tests.made_once import made_once
from tests.system.command_line import run_command

SECONDS = {"tma": 540, "active": 200}
"""Duration by scenario: of ``tma`` that of the tutorial, which goes on from the same bag."""


def shown_run(factory: pytest.TempPathFactory, scenario: str) -> Path:
    """Return the folder of ``bag`` and ``run.json`` of a scenario."""
    return made_once(factory, f"shown_{scenario}", partial(record, scenario=scenario))


def record(folder: Path, scenario: str) -> None:
    """Record a scenario at full speed."""
    arguments = ("run", scenario, "--duration", SECONDS[scenario], "--rate", "max", "--no-display")
    files = ("--record", folder / "bag", "--json", folder / "run.json")
    done = run_command(folder, *arguments, *files, pictures=True)
    assert done.returncode == 0, done.stdout
    assert "warning" not in done.stdout, done.stdout
