"""``sonar-tracking chaos``: runs that are disturbed on purpose, and a table of what came of it."""

from __future__ import annotations

import json as json_format
import math
import os
from collections.abc import Sequence
from contextlib import suppress
from datetime import datetime, timezone
from itertools import cycle
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
from rich.console import Console
from rich.progress import track

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.chaos.fault_plan import (
    DESCRIPTIONS,
    OF_THE_NETWORK,
    FaultKind,
    fault_kinds,
    plan_faults,
)
from sonar_tracking.graph.chaos.network import Network
from sonar_tracking.graph.chaos.outcome import Outcome, as_plain
from sonar_tracking.graph.chaos.outcome_table import outcome_table
from sonar_tracking.graph.chaos.track_identities import TrackList
from sonar_tracking.graph.chaos.watched_graph import WatchedGraph, watched_graph
from sonar_tracking.graph.verbs.run_options import rate_from_text

FAULTS_A_RUN = 3


def chaos(
    scenarios: Sequence[str],
    runs: int,
    seed: int,
    faults: str,
    rate: str,
    json: Path | None,
) -> int:
    """Disturb runs of scenarios and return the exit code: 1 if one of them failed.

    Parameters
    ----------
    scenarios : sequence of str
        Names or paths.
    runs : int
        Of all scenarios and kinds together, which take turns.
    seed : int
        Of targets and times.
    faults : str
        Kinds, with commas between; empty = all.
    rate : str
        Of the runs, as ``run`` takes it.
    json : Path or None
        Where the figures go.

    Raises
    ------
    ConfigurationError
        If what was asked cannot be done; nothing was started then.
    """
    kinds = fault_kinds(faults)
    graphs = [watched_graph(name) for name in scenarios]
    pace = rate_from_text(rate)
    if math.isinf(pace):
        raise ConfigurationError("chaos disturbs runs while they go on; give --rate a number.")
    network = Network(seed) if OF_THE_NETWORK & set(kinds) else None
    console = Console()
    folder = Path(mkdtemp(prefix="sonar_tracking-chaos-"))
    outcomes: list[Outcome] = []
    loads = []
    references: dict[str, Sequence[TrackList]] = {}
    turns = cycle([(graph, kind) for kind in kinds for graph in graphs])
    # Ctrl-C ends the campaign; what came of the runs before it is told all the same.
    with suppress(KeyboardInterrupt):
        for number in track(range(runs), "disturbed runs", console=console):
            place = folder / f"run_{number}"
            graph, kind = next(turns)
            outcomes += _suffered(graph, kind, pace, place, [seed, number], references, network)
            loads.append(os.getloadavg()[0])
    _tell(console, kinds, outcomes, folder)
    if json is not None:
        figures = {
            **{"scenarios": list(scenarios), "runs": len(loads), "seed": seed, "rate": pace},
            **_machine(loads),
            "faults": [as_plain(outcome) for outcome in outcomes],
        }
        json.write_text(json_format.dumps(figures, indent=2) + "\n")
    return int(any(each.failed for each in outcomes))


def _tell(
    console: Console, kinds: Sequence[FaultKind], outcomes: Sequence[Outcome], folder: Path
) -> None:
    console.print(outcome_table(outcomes))
    for kind in kinds:
        console.print(f"{kind.value}: {DESCRIPTIONS[kind]}", highlight=False)
    console.print(f"outputs and bags of the runs are in {folder}", highlight=False)


def _suffered(
    graph: WatchedGraph,
    kind: FaultKind,
    rate: float,
    folder: Path,
    seed: Sequence[int],
    references: dict[str, Sequence[TrackList]],
    network: Network | None,
) -> list[Outcome]:
    """Return what came of the faults of one run."""
    from sonar_tracking.graph.chaos.disturbed_run import DisturbedRun
    from sonar_tracking.graph.chaos.reference_run import reference_lists

    def reference() -> Sequence[TrackList]:
        if graph.scenario not in references:
            path = folder.with_name(f"{folder.name}_reference")
            references[graph.scenario] = reference_lists(graph, path)
        return references[graph.scenario]

    topics = [topic.name for topic in graph.inputs]
    planned = plan_faults(kind, graph.names, topics, FAULTS_A_RUN, np.random.default_rng(seed))
    return DisturbedRun(graph, rate, folder, reference, network).suffer(planned)


def _machine(loads: Sequence[float]) -> dict[str, object]:
    return {
        "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "processors": os.cpu_count(),
        "load": [min(loads, default=None), max(loads, default=None)],
    }
