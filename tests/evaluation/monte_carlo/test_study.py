"""Protects: the JSON that other programs read, and the terminal report that people read."""

import json
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sonar_tracking.evaluation.monte_carlo.study import Study, StudyRow, write_json
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.evaluation.monte_carlo.study_report import print_study

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


def test_a_table_wider_than_the_terminal_is_continued_below_and_nothing_is_cut_off() -> None:
    names = [f"metric {number}" for number in range(8)]
    condition = "a condition that says at length what was done to the target"
    rows = tuple(
        StudyRow(system, condition, {name: float(index) for index, name in enumerate(names)})
        for system in ("maximum likelihood, straight", "range bank (default)")
    )
    layout = TableLayout("Wide", tuple(Column(name, name, ".3f") for name in names))
    text = StringIO()
    print_study(Study("wide", 1, 1, 0.0, rows), (layout,), Console(file=text, width=60))
    lines = text.getvalue().splitlines()
    shown = [line for line in lines if line.lstrip().startswith("range bank (default)")]
    assert len(shown) > 1
    figures = [figure for line in shown for figure in line.split()[3:]]
    assert figures == [f"{index:.3f}" for index in range(8)]
    assert [heading for line in lines for heading in names if heading in line] == names
    assert lines.count(condition) == len(shown)
    assert max(len(line) for line in lines if line != condition) <= 60
