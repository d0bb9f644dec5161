"""The command ``sonar-tracking bench``: all parts, or one of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sonar_tracking.cli_loading import needs
from sonar_tracking.cli_options import JsonOption

CompareOption = Annotated[
    Path | None, typer.Option(help="JSON of another bench: print the ratio of every figure.")
]

bench_app = typer.Typer(invoke_without_command=True)


@bench_app.callback()
def bench(context: typer.Context, json: JsonOption = None, compare: CompareOption = None) -> None:
    """Measure the speed of kernels, stages and graph on this machine, beside peers.

    Without a part, all three one after the other, in less than five minutes on two idle cores.
    """
    if context.invoked_subcommand is None:
        _bench(("kernels", "stages", "graph"), json, compare)


@bench_app.command()
def kernels(json: JsonOption = None, compare: CompareOption = None) -> None:
    """Measure numerical kernels alone, beside the limits of the machine."""
    _bench(("kernels",), json, compare)


@bench_app.command()
def stages(json: JsonOption = None, compare: CompareOption = None) -> None:
    """Measure the stages on simulated data, and what the machine can track."""
    _bench(("stages",), json, compare)


@bench_app.command()
def graph(json: JsonOption = None, compare: CompareOption = None) -> None:
    """Measure whole graphs: throughput, latency, start, processor time and memory."""
    _bench(("graph",), json, compare)


def _bench(parts: tuple[str, ...], json: Path | None, compare: Path | None) -> None:
    needs("sonar_tracking.graph.verbs.bench_command").bench(parts, json, compare)
