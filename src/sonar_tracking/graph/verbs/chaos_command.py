"""``sonar-tracking chaos``: runs that are disturbed on purpose, and a table of what came of it."""

from __future__ import annotations

import json as json_format
from collections import defaultdict
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from itertools import cycle
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.scenario_graph import started_nodes
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    PASSIVE_TRACKS,
    Topic,
)
from sonar_tracking.graph.chaos.fault_plan import DESCRIPTIONS, fault_kinds, plan_faults
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

if TYPE_CHECKING:
    from sonar_tracking.graph.chaos.disturbed_run import Outcome

FAULTS_A_RUN = 3


def chaos(
    scenarios: Sequence[str],
    runs: int,
    seed: int,
    faults: str,
    rate: str,
    json: Path | None,
) -> int:
    """Disturb runs of scenarios and return the exit code: 1 if something stalled or was left.

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
    graphs = {name: _graph(name) for name in scenarios}
    from sonar_tracking.graph.chaos.disturbed_run import DisturbedRun, as_plain

    console = Console()
    folder = Path(mkdtemp(prefix="sonar_tracking-chaos-"))
    outcomes: list[Outcome] = []
    turns = cycle([(name, kind) for kind in kinds for name in scenarios])
    for number in track(range(runs), "disturbed runs", console=console):
        name, kind = next(turns)
        tracks, nodes, inputs = graphs[name]
        generator = np.random.default_rng([seed, number])
        topics = [topic.name for topic in inputs]
        planned = plan_faults(kind, nodes, topics, FAULTS_A_RUN, generator)
        run = DisturbedRun(name, rate, folder / f"run_{number}", tracks, inputs)
        outcomes += run.suffer(planned)
    console.print(_table(outcomes))
    for kind in kinds:
        console.print(f"{kind.value}: {DESCRIPTIONS[kind]}", highlight=False)
    console.print(f"outputs and bags of the runs are in {folder}")
    if json is not None:
        figures = {
            "scenarios": list(scenarios),
            "runs": runs,
            "seed": seed,
            "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
            "faults": [as_plain(outcome) for outcome in outcomes],
        }
        json.write_text(json_format.dumps(figures, indent=2) + "\n")
    return int(any(each.stalled or each.orphans or each.traceback for each in outcomes))


def _graph(name: str) -> tuple[Topic, list[str], list[Topic]]:
    """Return the lists of tracks of a scenario, its nodes and their inputs."""
    nodes = [node for node in started_nodes(load_scenario(name), name) if not node.is_display]
    published = [topic for node in nodes for topic in node.outputs]
    for tracks in (ACTIVE_TRACKS, PASSIVE_TRACKS, BEARING_TRACKS):
        if tracks in published:
            return tracks, [node.name for node in nodes], _inputs(nodes)
    raise ConfigurationError(f"{name} has no node that publishes tracks, so nothing to watch.")


def _inputs(nodes: Sequence[NodeDescription]) -> list[Topic]:
    published = {topic.name for node in nodes for topic in node.outputs}
    heard = {topic.name: topic for node in nodes for topic in (*node.inputs, *node.optional_inputs)}
    return [topic for name, topic in heard.items() if name in published]


def _table(outcomes: Sequence[Outcome]) -> Table:
    table = Table(title="what came of the faults")
    for heading in ("fault", "times", "tracks again, s: median, worst", "identities kept"):
        table.add_column(heading)
    for heading in ("stalls", "orphans", "tracebacks"):
        table.add_column(heading, justify="right")
    groups: Mapping[Any, list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        groups[outcome.fault.kind].append(outcome)
    for kind, group in groups.items():
        times = [each.recovered_s for each in group if each.recovered_s is not None]
        kept = [each.identities_kept for each in group if each.identities_kept is not None]
        table.add_row(
            kind.value,
            str(len(group)),
            f"{np.median(times):.1f}, {max(times):.1f}" if times else "",
            f"{sum(kept)} of {len(kept)}" if kept else "",
            *(str(sum(getattr(each, name) for each in group)) for name in _COUNTED),
        )
    return table


_COUNTED = ("stalled", "orphans", "traceback")
