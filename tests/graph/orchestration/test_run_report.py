"""The report is strict JSON, and its summary says what failed."""

import json
import math
from pathlib import Path

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.orchestration.run_report import NodeReport, RunReport, TopicReport
from sonar_tracking.graph.verbs.run_options import RunOptions, rate_from_text

REPORT = RunReport(
    scenario="doa_fusion",
    data_seconds=41.1,
    wall_seconds=8.22,
    nodes={"bearing_tracker": NodeReport(0, 1, 1.25, 42, 42)},
    topics={"/passive/bearing_tracks": TopicReport(42, "ab" * 32, False)},
    latency_ms={"p50": 3.0, "p99": math.nan, "algorithmic": 15.0, "count": 41},
    score={
        "rmse_deg": 0.695,
        "lost_tracks": 0,
        "median_error_deg": None,
        "positions": {"/active/tracks": {"rmse_m": 12.5}},
    },
    failures=["bearing_tracker was killed by SIGKILL."],
)


def test_the_json_is_strict(tmp_path: Path) -> None:
    path = tmp_path / "report.json"
    REPORT.write_json(path)

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    values = json.loads(path.read_text(), parse_constant=refuse)
    assert values["latency_ms"] == {"p50": 3.0, "p99": None, "algorithmic": 15.0, "count": 41}
    assert values["topics"]["/passive/bearing_tracks"] == {
        "messages": 42,
        "digest": "ab" * 32,
        "comparable": False,
    }
    assert values["nodes"]["bearing_tracker"]["restarts"] == 1
    assert values["exit_code"] == 1


def test_a_path_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="cannot be written"):
        REPORT.write_json(tmp_path)


def test_the_summary_names_what_matters() -> None:
    text = "\n".join(REPORT.lines())
    for words in (
        "5.0 x real time",
        "restarted 1 x",
        "not comparable",
        "p50 3.0 ms",
        "0.695 deg",
        "lost tracks              0",
        "/active/tracks against /truth/tracks:",
        "12.500 m",
        "failed: bearing_tracker was killed by SIGKILL.",
    ):
        assert words in text
    assert RunReport("nothing", 0.0, 0.0).lines() == [
        "nothing: 0.0 s of data in 0.0 s (0.0 x real time)"
    ]
    assert RunReport("nothing", 0.0, 0.0).exit_code == 0


def test_rates_as_typed() -> None:
    assert rate_from_text("max") == math.inf
    assert rate_from_text("2.5") == 2.5
    for text in ("0", "-1", "nan", "inf", "fast", ""):
        with pytest.raises(ConfigurationError, match="--rate"):
            rate_from_text(text)


def test_an_existing_bag_is_refused_before_the_run(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="exists already"):
        RunOptions(record=tmp_path).check()
    RunOptions(record=tmp_path / "new", json=tmp_path / "report.json").check()
