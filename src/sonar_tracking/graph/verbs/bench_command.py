"""``sonar-tracking bench``: parts measured, shown, written, compared with another bench."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.bench.bench import KERNELS, STAGES, PartDefinition, measure_part
from sonar_tracking.evaluation.bench.bench_report import (
    BenchPart,
    BenchReport,
    read_report,
    write_report,
)
from sonar_tracking.evaluation.bench.comparison import print_changes
from sonar_tracking.evaluation.bench.machine import Machine, measured_machine
from sonar_tracking.evaluation.monte_carlo.study_report import print_tables
from sonar_tracking.graph.verbs.machine_state import MESSAGE_PACKAGE


def bench(parts: Sequence[str], json: Path | None, compare: Path | None) -> None:
    """Measure parts of the bench, print their tables and write what was asked for.

    Parameters
    ----------
    parts : sequence of str
        kernels, stages, graph.
    json : Path or None
        File for the figures.
    compare : Path or None
        Figures of another bench; the ratios are printed.

    Raises
    ------
    ConfigurationError
        If a file cannot be used; nothing was measured then.
    """
    old = read_report(compare) if compare is not None else None
    if json is not None and not json.resolve().parent.is_dir():
        raise ConfigurationError(
            f"--json: the folder {json.resolve().parent} does not exist; make it first."
        )
    console = Console()
    definitions = [_definition(name) for name in _possible(parts, console)]
    machine = measured_machine()
    console.print(machine.in_words(), highlight=False)
    report = BenchReport(machine.as_mapping(), ())
    for definition in definitions:
        part = _measured(definition, machine, console)
        _show(part, definition, console)
        report = replace(report, parts=(*report.parts, part))
        if json is not None:
            write_report(report, json)
    if old is not None:
        print_changes(old, report, console)


def _possible(parts: Sequence[str], console: Console) -> Sequence[str]:
    """Return the parts without that of the graph if ROS is missing and others were asked for.

    Raises
    ------
    ModuleNotFoundError
        If it alone was asked for.
    """
    for package in ("rclpy", MESSAGE_PACKAGE):
        if "graph" in parts and find_spec(package) is None:
            if len(parts) == 1:
                raise ModuleNotFoundError(package, name=package)
            words = f"{package} is not installed: the part 'graph' is left out."
            console.print(words, style="yellow", highlight=False)
            return [part for part in parts if part != "graph"]
    return parts


def _definition(name: str) -> PartDefinition:
    if name == "graph":
        # The parts without it do without ROS.
        from sonar_tracking.graph.bench.graph_part import GRAPH

        return GRAPH
    return {"kernels": KERNELS, "stages": STAGES}[name]


def _measured(definition: PartDefinition, machine: Machine, console: Console) -> BenchPart:
    columns = (TextColumn("{task.fields[part]}"), BarColumn(), TextColumn("{task.description}"))
    with Progress(*columns, TimeElapsedColumn(), console=console, transient=True) as progress:
        bar = progress.add_task("", total=None, part=definition.name)

        def begun(label: str, number: int, count: int) -> None:
            progress.update(bar, description=label, completed=number, total=count)

        return measure_part(definition, machine, begun)


def _show(part: BenchPart, definition: PartDefinition, console: Console) -> None:
    print_tables(part.rows, definition.layouts, console)
    for sentence in part.missing:
        console.print(sentence, style="yellow", highlight=False)
    words = f"\n{part.name}: {part.seconds:.0f} s, load {part.load:.1f}"
    console.print(words, highlight=False)
