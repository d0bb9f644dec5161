"""Protects the format of the figures, their comparison, and what follows from them by hand."""

import json
import math
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.bench import kernel as kernel_module
from sonar_tracking.evaluation.bench.array_stages import DEFAULT
from sonar_tracking.evaluation.bench.bench import (
    KERNELS,
    STAGES,
    PartDefinition,
    Step,
    measure_part,
)
from sonar_tracking.evaluation.bench.bench_report import (
    FORMAT,
    VERSION,
    BenchPart,
    BenchReport,
    read_report,
    write_report,
)
from sonar_tracking.evaluation.bench.capacity import capacity
from sonar_tracking.evaluation.bench.comparison import changes, print_changes
from sonar_tracking.evaluation.bench.contact_stages import SYSTEMS
from sonar_tracking.evaluation.bench.kernel import Kernel, Prepared, Timed, Work, measure_kernel
from sonar_tracking.evaluation.bench.machine import Machine
from sonar_tracking.evaluation.bench.timing import cpu_seconds, scaling_exponent
from sonar_tracking.evaluation.bench.tma_stages import CROSS_FIX
from sonar_tracking.evaluation.monte_carlo.study import StudyRow

MACHINE = Machine(
    date="2026-01-01T00:00:00+00:00",
    version="1.0",
    cpu="a processor",
    cores=2,
    load=0.5,
    system="a system",
    python="3.12",
    numpy="2.0",
    blas="a library",
    dgemm_gflops=10.0,
    copy_gb_s=5.0,
)
ROW = StudyRow("elements 15", "MUSIC", {"microseconds": 250.0, "exponent": math.nan})
REPORT = BenchReport(MACHINE.as_mapping(), (BenchPart("kernels", (ROW,), ("none",), 3.0, 0.7),))


def test_the_file_has_the_stable_format(tmp_path: Path) -> None:
    write_report(REPORT, tmp_path / "bench.json")
    content = json.loads((tmp_path / "bench.json").read_text())
    assert content == {
        "format": FORMAT,
        "version": 1,
        "machine": MACHINE.as_mapping(),
        "parts": {
            "kernels": {
                "seconds": 3.0,
                "load": 0.7,
                "missing": ["none"],
                "rows": [
                    {
                        "name": "elements 15",
                        "condition": "MUSIC",
                        "figures": {"microseconds": 250.0},
                    }
                ],
            }
        },
    }
    assert {"cpu", "cores", "numpy", "blas", "date", "load"} <= set(content["machine"])
    again = read_report(tmp_path / "bench.json")
    assert again.as_mapping() == REPORT.as_mapping()


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": "another"}'])
def test_a_file_that_is_no_bench_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(ConfigurationError, match=r"other\.json is no report of a bench"):
        read_report(tmp_path / "other.json")


def test_another_version_is_refused(tmp_path: Path) -> None:
    values = {**REPORT.as_mapping(), "version": VERSION + 1}
    (tmp_path / "newer.json").write_text(json.dumps(values))
    with pytest.raises(ConfigurationError, match=f"version {VERSION + 1}"):
        read_report(tmp_path / "newer.json")


def test_figures_are_compared_row_by_row() -> None:
    faster = replace(ROW, metrics={"microseconds": 100.0, "copy_percent": 3.0})
    added = StudyRow("elements 64", "MUSIC", {"microseconds": 900.0})
    new = replace(REPORT, parts=(replace(REPORT.parts[0], rows=(faster, added)),))
    (change,) = changes(REPORT, new)
    assert (change.figure, change.ratio) == ("microseconds", 0.4)
    text = StringIO()
    print_changes(REPORT, new, Console(file=text, width=200))
    assert "0.400  elements 15, microseconds: 250 -> 100" in text.getvalue()
    assert "new  kernels: MUSIC, elements 64" in text.getvalue()


def test_the_exponent_of_a_power_law_is_its_power() -> None:
    sizes = [15.0, 64.0, 256.0, 512.0]
    assert scaling_exponent(sizes, [3e-6 * n**1.5 for n in sizes]) == pytest.approx(1.5)
    assert math.isnan(scaling_exponent([15.0], [1.0]))


def test_a_call_is_timed_in_seconds_of_the_processor() -> None:
    calls = []
    seconds = cpu_seconds(lambda: calls.append(sum(range(20_000))), 0.0)
    assert len(calls) > 3
    assert 1e-6 < seconds < 1.0


def test_shares_of_the_machine_are_of_the_least_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_module, "cpu_seconds", lambda call, _: call())
    kernel = Kernel(
        "a step",
        "elements",
        (10, 100),
        lambda size: Prepared(
            # 1e-3 s and 1e-2 s for two steps; the peer takes twice as long.
            Timed(lambda: 1e-4 * size, 2),
            Work(flops=5e4 * size, bytes=2.5e4 * size),
            {"another": Timed(lambda: 1e-4 * size)},
        ),
    )
    rows = {row.system: row.metrics for row in measure_kernel(kernel, MACHINE)}
    # 5e5 operations in 0.5 ms are 1e9 a second, of 1e10; 2.5e5 bytes are 5e8 a second, of 5e9.
    assert rows["elements 10"] == pytest.approx(
        {"microseconds": 500.0, "dgemm_percent": 10.0, "copy_percent": 10.0}
    )
    assert rows["elements 100"]["exponent"] == pytest.approx(1.0)
    assert rows["elements 100, peer: another"]["peer_over_ours"] == pytest.approx(2.0)


def test_what_a_machine_can_track_follows_from_the_costs() -> None:
    array = {
        "microseconds_per_snapshot": 100.0,
        "milliseconds_per_estimate": 50.0,
        "milliseconds_per_track_update": 20.0,
        "times_real_time": 8.3,
    }
    rows = (
        StudyRow("elements 64", f"{DEFAULT}, 5 sources", array),
        StudyRow("clutter 50", SYSTEMS[0], {"milliseconds_per_ping": 5.0}),
        StudyRow("targets 3", CROSS_FIX, {"milliseconds_per_frame": 10.0}),
    )
    arrays, contacts, positions = capacity(rows)
    # Two estimates take 0.1 s of the half core: 0.4 s / 100 us; 200 snapshots take 0.02 s.
    assert arrays.metrics == pytest.approx(
        {"snapshots_per_second": 4000.0, "estimates_per_second": 9.6}
    )
    assert contacts.metrics == pytest.approx({"pings_per_second": 100.0})
    assert positions.metrics == pytest.approx({"frames_per_second": 50.0})


def test_a_tracker_that_is_too_slow_keeps_no_real_time() -> None:
    slow = {
        "microseconds_per_snapshot": 100.0,
        "milliseconds_per_estimate": 1.0,
        "milliseconds_per_track_update": 300.0,
        "times_real_time": 1.0,
    }
    (row,) = capacity([StudyRow("elements 512", f"{DEFAULT}, 2 sources", slow)])
    assert row.metrics["snapshots_per_second"] == 0.0


def test_steps_are_announced_and_their_rows_kept() -> None:
    seen = []
    definition = PartDefinition("a part", lambda _: [Step("a step", lambda: (ROW,))], ())
    part = measure_part(definition, MACHINE, lambda *step: seen.append(step))
    assert seen == [("a step", 0, 1)]
    assert part.rows == (ROW,)


def test_every_part_has_steps_of_different_names() -> None:
    for definition in (KERNELS, STAGES):
        labels = [step.label for step in definition.steps(MACHINE)]
        assert len(labels) == len(set(labels)) > 10
