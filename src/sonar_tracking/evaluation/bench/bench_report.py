"""The figures of a bench in one format, which stays the same from release to release.

    {"format": "sonar_tracking bench", "version": 1, "machine": {...},
     "parts": {"kernels": {"seconds": ..., "load": ..., "missing": [...],
               "rows": [{"name": ..., "condition": ..., "figures": {...}}, ...]}, ...}}

A row is found again by part, condition and name; the unit ends the name of a figure.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.monte_carlo.study import StudyRow

FORMAT = "sonar_tracking bench"
VERSION = 1


@dataclass(frozen=True)
class BenchPart:
    """Figures of one part.

    Attributes
    ----------
    name : str
        kernels, stages or graph.
    rows : tuple of StudyRow
        What was measured, under which condition.
    missing : tuple of str
        A sentence for each peer that is not there.
    seconds : float
        Wall time it took, s.
    load : float
        Processes that wanted to run, mean of its last minute.
    """

    name: str
    rows: tuple[StudyRow, ...]
    missing: tuple[str, ...] = ()
    seconds: float = 0.0
    load: float = 0.0


@dataclass(frozen=True)
class BenchReport:
    """Figures of one bench.

    Attributes
    ----------
    machine : mapping
        See :class:`~sonar_tracking.evaluation.bench.machine.Machine`.
    parts : tuple of BenchPart
        In order.
    """

    machine: Mapping[str, Any]
    parts: tuple[BenchPart, ...]

    @property
    def rows(self) -> tuple[StudyRow, ...]:
        """Those of all parts."""
        return tuple(row for part in self.parts for row in part.rows)

    def as_mapping(self) -> dict[str, object]:
        """Return what stands in the file."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "machine": dict(self.machine),
            "parts": {part.name: _part(part) for part in self.parts},
        }


def write_report(report: BenchReport, path: Path) -> None:
    """Write a report as JSON; figures that are not finite are left out."""
    text = json.dumps(report.as_mapping(), indent=1, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def read_report(path: Path) -> BenchReport:
    """Return a report that was written before.

    Raises
    ------
    ConfigurationError
        If the file holds none, or one of another version.
    """
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        known = values["format"] == FORMAT
    except (ValueError, TypeError, KeyError):
        known = False
    if not known:
        raise ConfigurationError(
            f"{path} is no report of a bench; give one written by sonar-tracking bench --json."
        )
    if values["version"] != VERSION:
        raise ConfigurationError(
            f"{path} is a report of version {values['version']}; this bench compares version "
            f"{VERSION}: measure again with the release that wrote it."
        )
    parts = [_read_part(name, part) for name, part in values["parts"].items()]
    return BenchReport(values["machine"], tuple(parts))


def _part(part: BenchPart) -> dict[str, object]:
    return {
        "seconds": round(part.seconds, 1),
        "load": round(part.load, 2),
        "missing": list(part.missing),
        "rows": [
            {"name": row.system, "condition": row.condition, "figures": _rounded(row.metrics)}
            for row in part.rows
        ],
    }


def _read_part(name: str, values: Mapping[str, Any]) -> BenchPart:
    rows = [StudyRow(row["name"], row["condition"], row["figures"]) for row in values["rows"]]
    load = float(values["load"])
    return BenchPart(name, tuple(rows), tuple(values["missing"]), float(values["seconds"]), load)


def _rounded(figures: Mapping[str, float]) -> dict[str, float]:
    """Return the finite figures with as many digits as a measurement has."""
    return {name: float(f"{value:.4g}") for name, value in figures.items() if math.isfinite(value)}
