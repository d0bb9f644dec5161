"""Protects what is made of a measured run: causes of processor time, latency, start, memory."""

import os
import sys
import time
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

import pytest

from sonar_tracking import cli
from sonar_tracking.evaluation.bench.bench import PartDefinition, Step
from sonar_tracking.evaluation.bench.bench_report import read_report
from sonar_tracking.evaluation.bench.machine import Machine
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.graph.bench.graph_cases import graph_cases
from sonar_tracking.graph.bench.graph_rows import graph_rows
from sonar_tracking.graph.bench.measured_run import ORCHESTRATION, MeasuredRun
from sonar_tracking.graph.bench.process_figures import nodes_of_run, process_figures
from sonar_tracking.graph.verbs import bench_command
from sonar_tracking.simulation.scenarios.scenario_checks import check_scenario

RUN = MeasuredRun(
    report={
        "data_seconds": 100.0,
        "wall_seconds": 5.0,
        "failures": [],
        "nodes": {"tracker": {"messages_in": 60, "messages_out": 40}},
        "latency_ms": {"p50": 5.0, "p99": 9.0, "first": 7.0, "count": 400},
    },
    spawned=0.5,
    data_flow=1.5,
    first_track=2.5,
    start_seconds={"tracker": 1.0, ORCHESTRATION: 1.0},
    cpu_seconds={"tracker": 4.0, ORCHESTRATION: 4.0},
    memory_mb={"tracker": 80.0, ORCHESTRATION: 100.0},
)


def rows_of(costs: dict[str, float], is_paced: bool = False) -> dict[str, dict[str, float]]:
    return {row.system: dict(row.metrics) for row in graph_rows("run", RUN, costs, is_paced)}


def test_processor_time_is_start_mathematics_and_messages() -> None:
    rows = rows_of({"tracker": 2.0})
    # Of 8 s: 2 s of start, 2 s of the tracker's mathematics, 4 s of messages.
    assert rows["throughput"] == pytest.approx(
        {
            "times_real_time": 20.0,
            "data_seconds": 100.0,
            "failures": 0.0,
            "graph_cpu_seconds": 8.0,
            "start_percent": 25.0,
            "mathematics_percent": 25.0,
            "messages_percent": 50.0,
            "messages_milliseconds_per_data_second": 40.0,
        }
    )
    assert rows["tracker"]["cpu_messages_seconds"] == pytest.approx(1.0)
    assert rows["tracker"]["milliseconds_per_message"] == pytest.approx(10.0)
    assert rows[ORCHESTRATION]["cpu_mathematics_seconds"] == 0.0
    assert rows["start"]["first_track_seconds"] == 2.5


def test_a_stage_alone_is_never_dearer_than_its_node() -> None:
    rows = rows_of({"tracker": 9.0})
    assert rows["tracker"]["cpu_mathematics_seconds"] == pytest.approx(3.0)
    assert rows["tracker"]["cpu_messages_seconds"] == pytest.approx(0.0)


def test_without_costs_nothing_is_said_of_causes() -> None:
    rows = rows_of({})
    assert "messages_percent" not in rows["throughput"]
    assert "cpu_messages_seconds" not in rows["tracker"]


def test_latency_is_told_of_paced_runs_alone() -> None:
    assert "latency" not in rows_of({})
    assert rows_of({}, is_paced=True)["latency"] == pytest.approx(
        {
            "p50_milliseconds": 5.0,
            "p99_milliseconds": 9.0,
            "first_milliseconds": 7.0,
            "estimates": 400.0,
        }
    )


def test_figures_of_this_process_are_those_it_knows_itself() -> None:
    figures = process_figures(os.getpid())
    assert figures is not None
    assert 0.0 < figures.started <= time.clock_gettime(time.CLOCK_BOOTTIME)
    assert figures.cpu_seconds == pytest.approx(time.process_time(), abs=0.1)
    assert figures.memory_mb > 10.0
    assert process_figures(-1) is None
    assert nodes_of_run(os.getpid()) == {}


def test_the_runs_of_the_bench_are_valid_and_have_names_of_their_own() -> None:
    cases = graph_cases()
    assert len({case.name for case in cases}) == len(cases)
    for case in cases:
        check_scenario(case.scenario, case.name)
    paced = [case for case in cases if case.rate != "max"]
    assert paced[0].scenario.duration / 0.1 > 300
    assert any(len(case.scenario.array.element_positions()) == 512 for case in cases)


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let nothing be measured of this machine."""
    names = [each.name for each in fields(Machine)]
    one = Machine(**dict.fromkeys(names, 1.0))  # type: ignore[arg-type]
    monkeypatch.setattr(bench_command, "measured_machine", lambda: one)


def short_bench(row: StudyRow) -> PartDefinition:
    return PartDefinition("kernels", lambda _: [Step("a step", lambda: (row,))], ())


def bench(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["sonar-tracking", "bench", *arguments])
    try:
        return cli.main()
    except SystemExit as ended:
        return int(ended.code or 0)


@pytest.mark.usefixtures("machine")
def test_a_bench_is_written_and_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    old, new = tmp_path / "old.json", tmp_path / "new.json"
    for path, value, options in ((old, 2.0, ()), (new, 1.0, ("--compare", str(old)))):
        row = StudyRow("elements 15", "MUSIC", {"microseconds": value})
        monkeypatch.setattr(bench_command, "KERNELS", short_bench(row))
        assert bench(monkeypatch, "kernels", "--json", str(path), *options) == 0
    assert "0.500  elements 15, microseconds: 2 -> 1" in capsys.readouterr().out
    assert read_report(new).rows[0].metrics == {"microseconds": 1.0}


def test_what_cannot_be_compared_is_refused_before_anything_is_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "study.json").write_text("{}")
    monkeypatch.setattr(bench_command, "measured_machine", lambda: pytest.fail("measured"))
    assert bench(monkeypatch, "kernels", "--compare", str(tmp_path / "study.json")) == 2
    assert "is no report of a bench" in capsys.readouterr().err


@pytest.mark.usefixtures("machine")
def test_without_ros_the_graph_is_left_out_and_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(bench_command, "find_spec", lambda _: None)
    measured: list[str] = []

    def measure(definition: PartDefinition, *_: object) -> None:
        measured.append(definition.name)
        raise KeyboardInterrupt

    monkeypatch.setattr(bench_command, "measure_part", measure)
    with pytest.raises(KeyboardInterrupt):
        bench_command.bench(("kernels", "graph"), None, None)
    assert measured == ["kernels"]
    assert "the part 'graph' is left out" in capsys.readouterr().out
    assert bench(monkeypatch, "graph") == 2


@pytest.mark.parametrize("arguments", [[], ["kernels"], ["stages"], ["graph"]])
def test_without_a_part_all_three_are_measured(
    arguments: Sequence[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Sequence[str]] = []
    monkeypatch.setattr(bench_command, "bench", lambda parts, *_: asked.append(list(parts)))
    assert bench(monkeypatch, *arguments) == 0
    assert asked == [list(arguments) or ["kernels", "stages", "graph"]]
