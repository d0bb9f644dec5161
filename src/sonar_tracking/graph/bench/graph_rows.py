"""The figures of a measured run, as rows of the bench."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.graph.bench.measured_run import MeasuredRun

GRAPH_LAYOUTS = (
    TableLayout(
        "Throughput of whole graphs",
        (
            Column("times_real_time", "x real time", ".1f"),
            Column("data_seconds", "data, s", ".0f"),
            Column("failures", "failures", ".0f"),
            Column("graph_cpu_seconds", "CPU, s", ".1f"),
            Column("start_percent", "start, %", ".0f"),
            Column("mathematics_percent", "maths, %", ".0f"),
            Column("messages_percent", "messages, %", ".0f"),
            Column("messages_milliseconds_per_data_second", "messages, ms/s", ".1f"),
        ),
        "Start: processor time until data flow. Maths: of the same stages on the same data in one "
        "process. Messages: all the rest; their share grows when the others need less: ms/s is for "
        "each second of data. Failures: what the run reports, such as a rate that it "
        "did not keep.",
    ),
    TableLayout(
        "Latency, from the data that complete an estimate to its tracks",
        (
            Column("p50_milliseconds", "p50, ms", ".1f"),
            Column("p99_milliseconds", "p99, ms", ".1f"),
            Column("first_milliseconds", "first, ms", ".1f"),
            Column("estimates", "estimates", ".0f"),
        ),
        "At the rate of the data: a graph that runs as fast as it can always has a queue.",
    ),
    TableLayout(
        "Start, seconds after the command",
        (
            Column("spawned_seconds", "nodes spawned", ".2f"),
            Column("data_flow_seconds", "connected, data flow", ".2f"),
            Column("first_track_seconds", "first tracks received", ".2f"),
            Column("node_count", "nodes", ".0f"),
        ),
        "The first list of tracks as another process receives it, empty or not.",
    ),
    TableLayout(
        "Processes of the graphs",
        (
            Column("cpu_seconds", "CPU, s", ".2f"),
            Column("cpu_start_seconds", "start, s", ".2f"),
            Column("cpu_mathematics_seconds", "maths, s", ".2f"),
            Column("cpu_messages_seconds", "messages, s", ".2f"),
            Column("milliseconds_per_message", "ms/message", ".2f"),
            Column("memory_mb", "memory, MB", ".0f"),
        ),
        "ms/message: of messages, for each that comes or goes. Memory: the most that was resident, "
        "with what the processes share in each of them. The orchestration serves the clock, and "
        "counts, compares and scores what it sees.",
    ),
)


def graph_rows(
    name: str, run: MeasuredRun, costs: Mapping[str, float], is_paced: bool
) -> Iterator[StudyRow]:
    """Yield the rows of a run.

    Parameters
    ----------
    name : str
        Of the run.
    run : MeasuredRun
        What was measured.
    costs : mapping of str to float
        Processor time of the mathematics of each node, s; empty = not known.
    is_paced : bool
        Whether data came at their own rate: only then do estimates not wait for one another.
    """
    processes = {node: _process(node, run, costs) for node in run.cpu_seconds}
    report = run.report
    wall = float(report["wall_seconds"])
    figures = {
        "times_real_time": report["data_seconds"] / wall,
        "data_seconds": report["data_seconds"],
        "failures": float(len(report["failures"])),
        **_shares(processes, costs, report["data_seconds"]),
    }
    yield StudyRow("throughput", name, figures)
    if is_paced:
        yield from _latency(name, report)
    figures = {
        "spawned_seconds": run.spawned,
        "data_flow_seconds": run.data_flow,
        "first_track_seconds": run.first_track,
        "node_count": float(len(report["nodes"])),
    }
    yield StudyRow("start", name, figures)
    for node, values in processes.items():
        yield StudyRow(node, name, values)


def _latency(name: str, report: Mapping[str, Mapping[str, float]]) -> Iterator[StudyRow]:
    latency = report["latency_ms"]
    if latency.get("count"):
        yield StudyRow(
            "latency",
            name,
            {
                "p50_milliseconds": latency["p50"],
                "p99_milliseconds": latency["p99"],
                "first_milliseconds": latency["first"],
                "estimates": float(latency["count"]),
            },
        )


def _process(node: str, run: MeasuredRun, costs: Mapping[str, float]) -> dict[str, float]:
    total = run.cpu_seconds[node]
    start = min(run.start_seconds.get(node, math.nan), total)
    figures = {
        "cpu_seconds": total,
        "cpu_start_seconds": start,
        "memory_mb": run.memory_mb.get(node, math.nan),
    }
    if costs:
        # Measured by themselves, the same stages may take a little more than in the graph.
        mathematics = min(costs.get(node, 0.0), total - start)
        figures["cpu_mathematics_seconds"] = mathematics
        messages = total - start - mathematics
        figures["cpu_messages_seconds"] = messages
        counts = run.report["nodes"].get(node, {})
        passed = counts.get("messages_in", 0) + counts.get("messages_out", 0)
        figures["milliseconds_per_message"] = 1e3 * messages / passed if passed else math.nan
    return figures


def _shares(
    processes: Mapping[str, Mapping[str, float]], costs: Mapping[str, float], data_seconds: float
) -> dict[str, float]:
    def total(figure: str) -> float:
        return sum(each[figure] for each in processes.values())

    whole = total("cpu_seconds")
    figures = {
        "graph_cpu_seconds": whole,
        "start_percent": 100.0 * total("cpu_start_seconds") / whole,
    }
    if costs:
        figures["mathematics_percent"] = 100.0 * total("cpu_mathematics_seconds") / whole
        messages = total("cpu_messages_seconds")
        figures["messages_percent"] = 100.0 * messages / whole
        figures["messages_milliseconds_per_data_second"] = 1e3 * messages / data_seconds
    return figures
