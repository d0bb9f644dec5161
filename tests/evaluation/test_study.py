"""Protects: the JSON that other programs read, and the terminal report that people read."""

import json
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sonar_tracking.evaluation.study import Study, StudyRow, write_json
from sonar_tracking.evaluation.study_definition import Column, TableLayout
from sonar_tracking.evaluation.study_report import print_study

ROWS = (
    StudyRow("A", "calm", {"error_deg": 0.5, "success_percent": 98.0}, {"error_deg": 0.4}),
    StudyRow("B", "calm", {"error_deg": np.nan, "success_percent": 0.0}),
    StudyRow("C", "other", {"ratio": 2.0}),
)
STUDY = Study("example", 7, 3, 1.23456, ROWS)
LAYOUT = TableLayout(
    "Errors", (Column("error_deg", "error (deg)", ".2f"), Column("success_percent", "%", ".0f"))
)


def test_json_has_exactly_the_agreed_fields() -> None:
    content = json.loads(STUDY.to_json())
    assert list(content) == ["study", "runs", "seed", "seconds", "rows"]
    assert content["study"] == "example"
    assert (content["runs"], content["seed"], content["seconds"]) == (7, 3, 1.235)
    for row in content["rows"]:
        assert list(row) == ["system", "condition", "metrics", "published"]
    assert content["rows"][0]["published"] == {"error_deg": 0.4}


def test_an_undefined_figure_is_left_out_of_the_json() -> None:
    content = json.loads(STUDY.to_json())
    assert content["rows"][1]["metrics"] == {"success_percent": 0.0}


def test_several_studies_are_written_as_a_list(tmp_path: Path) -> None:
    path = tmp_path / "new" / "studies.json"
    write_json((STUDY, STUDY), path)
    assert len(json.loads(path.read_text())) == 2
    write_json((STUDY,), path)
    assert json.loads(path.read_text())["study"] == "example"


def test_a_row_is_found_by_system_and_condition() -> None:
    assert STUDY.row("C", "other").metrics["ratio"] == 2.0
    with pytest.raises(KeyError, match="no row of C under calm"):
        STUDY.row("C", "calm")


def test_report_shows_published_figures_beside_measured_ones() -> None:
    text = StringIO()
    print_study(STUDY, (LAYOUT,), Console(file=text, width=100))
    lines = text.getvalue().splitlines()
    heading = next(line for line in lines if "error (deg)" in line)
    assert any(line.split() == ["calm"] for line in lines)
    assert heading.split()[-2:] == ["paper", "%"]
    first = next(line for line in lines if " A " in line)
    assert first.split() == ["A", "0.50", "0.40", "98"]
    assert next(line for line in lines if " B " in line).split() == ["B", "-", "0"]
    assert not any("C" in line.split() for line in lines)
