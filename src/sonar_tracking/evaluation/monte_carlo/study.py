"""The result of a Monte Carlo study: rows of measured figures with the published ones beside."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class StudyRow:
    """What one system did under one condition.

    Attributes
    ----------
    system : str
        What was measured, e.g. ``"PROPOSED"``.
    condition : str
        Under which condition, e.g. ``"SNR -5 dB"``.
    metrics : mapping of str to float
        Measured figures; the unit ends the name. A figure that does not exist (the error of
        successful runs when none succeeded) is NaN here and left out of the JSON.
    published : mapping of str to float
        Published figures under the names of the metrics they stand beside.
    """

    system: str
    condition: str
    metrics: Mapping[str, float]
    published: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Study:
    """Outcome of one study.

    Attributes
    ----------
    study : str
        Name, as typed on the command line.
    runs : int
        Monte Carlo runs per condition.
    seed : int
        Root of all randomness.
    seconds : float
        Wall time it took, s.
    rows : tuple of StudyRow
        In the order of the report.
    """

    study: str
    runs: int
    seed: int
    seconds: float
    rows: tuple[StudyRow, ...]

    def row(self, system: str, condition: str) -> StudyRow:
        """Return the row of ``system`` under ``condition``.

        Raises
        ------
        KeyError
            If there is none.
        """
        for row in self.rows:
            if row.system == system and row.condition == condition:
                return row
        raise KeyError(f"study {self.study} has no row of {system} under {condition}.")

    def to_json(self) -> str:
        """Return the study as JSON text: study, runs, seed, seconds and the list of rows."""
        return json.dumps(self.as_mapping(), indent=2, allow_nan=False)

    def as_mapping(self) -> dict[str, object]:
        """Return the study as plain dictionaries and lists, as they stand in the JSON."""
        return {
            "study": self.study,
            "runs": self.runs,
            "seed": self.seed,
            "seconds": round(self.seconds, 3),
            "rows": [
                {
                    "system": row.system,
                    "condition": row.condition,
                    "metrics": _finite(row.metrics),
                    "published": _finite(row.published),
                }
                for row in self.rows
            ],
        }


def write_json(studies: tuple[Study, ...], path: Path) -> None:
    """Write one study as an object, several as a list of such objects.

    Parameters
    ----------
    studies : tuple of Study
        What to write.
    path : Path
        File to write; missing directories are made.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    if len(studies) == 1:
        text = studies[0].to_json()
    else:
        mappings = [study.as_mapping() for study in studies]
        text = json.dumps(mappings, indent=2, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def _finite(figures: Mapping[str, float]) -> dict[str, float]:
    return {name: float(value) for name, value in figures.items() if math.isfinite(value)}
