"""Scenarios of the package, of which a test needs less."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sonar_tracking.resources import find_resource


def changed_scenario(folder: Path, name: str, changes: Mapping[str, str]) -> Path:
    """Write a scenario in which some texts, each of which it has once, are others."""
    text = find_resource(f"config/scenarios/{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path = folder / f"{name}.yaml"
    path.write_text(text, encoding="utf-8")
    return path
