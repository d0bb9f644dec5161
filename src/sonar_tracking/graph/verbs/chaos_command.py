"""``sonar-tracking chaos``: runs that are disturbed on purpose, and a table of what came of it."""

from __future__ import annotations

import json as json_format
import math
import os
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from itertools import cycle
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG
from sonar_tracking.evaluation.metrics.cutoff import CUTOFF_M
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.scenario_graph import started_nodes
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    PASSIVE_TRACKS,
    Topic,
)
from sonar_tracking.graph.chaos import network
from sonar_tracking.graph.chaos.fault_plan import (
    DESCRIPTIONS,
    OF_THE_NETWORK,
    FaultKind,
    fault_kinds,
    plan_faults,
)
from sonar_tracking.graph.verbs.run_options import rate_from_text
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

if TYPE_CHECKING:
    from sonar_tracking.graph.chaos.disturbed_run import Outcome

FAULTS_A_RUN = 3
IN_TIME = 5.0
"""By then tracks are to come again, s of the wall clock after they were due."""


@dataclass(frozen=True)
class WatchedGraph:
    """What is watched of a scenario, and can be disturbed."""

    tracks: Topic
    nodes: tuple[NodeDescription, ...]

    @property
    def names(self) -> list[str]:
        """Names of the nodes."""
        return [node.name for node in self.nodes]

    @property
    def cutoff(self) -> float:
        """Farthest a track is from its target, m or rad."""
        return math.radians(CUTOFF_DEG) if self.tracks is BEARING_TRACKS else CUTOFF_M

    @property
    def inputs(self) -> list[Topic]:
        """Topics of the graph that one of its nodes hears."""
        heard = [
            topic
            for node in self.nodes
            for topic in (*node.inputs, *node.optional_inputs, *node.topic_parameters.values())
        ]
        published = {topic.name for node in self.nodes for topic in _outputs(node)}
        return list({topic.name: topic for topic in heard if topic.name in published}.values())

    @property
    def published(self) -> dict[str, list[str]]:
        """Full names of the topics of each node."""
        return {
            node.name: [ROOT_NAMES.of(topic) for topic in _outputs(node)] for node in self.nodes
        }


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
    graphs = {name: _graph(name) for name in scenarios}
    pace = rate_from_text(rate)
    if math.isinf(pace):
        raise ConfigurationError("chaos disturbs runs while they go on; give --rate a number.")
    if OF_THE_NETWORK & set(kinds):
        network.enter()
    from sonar_tracking.graph.chaos.disturbed_run import DisturbedRun

    console = Console()
    folder = Path(mkdtemp(prefix="sonar_tracking-chaos-"))
    outcomes: list[Outcome] = []
    turns = cycle([(name, kind) for kind in kinds for name in scenarios])
    loads = []
    for number in track(range(runs), "disturbed runs", console=console):
        name, kind = next(turns)
        graph = graphs[name]
        generator = np.random.default_rng([seed, number])
        topics = [topic.name for topic in graph.inputs]
        planned = plan_faults(kind, graph.names, topics, FAULTS_A_RUN, generator)
        run = DisturbedRun(
            name,
            pace,
            folder / f"run_{number}",
            graph.tracks,
            graph.cutoff,
            graph.inputs,
            graph.published,
        )
        outcomes += run.suffer(planned)
        loads.append(os.getloadavg()[0])
    console.print(_table(outcomes))
    for kind in kinds:
        console.print(f"{kind.value}: {DESCRIPTIONS[kind]}", highlight=False)
    console.print(
        f"load {min(loads):.1f} to {max(loads):.1f} on {os.cpu_count()} processors; outputs and "
        f"bags of the runs are in {folder}",
        highlight=False,
    )
    if json is not None:
        figures = _figures(scenarios, runs, seed, pace, loads, outcomes)
        json.write_text(json_format.dumps(figures, indent=2) + "\n")
    return int(any(each.failed for each in outcomes))


def _figures(
    scenarios: Sequence[str],
    runs: int,
    seed: int,
    rate: float,
    loads: Sequence[float],
    outcomes: Sequence[Outcome],
) -> dict[str, object]:
    from sonar_tracking.graph.chaos.disturbed_run import as_plain

    return {
        "scenarios": list(scenarios),
        "runs": runs,
        "seed": seed,
        "rate": rate,
        "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "processors": os.cpu_count(),
        "load": [min(loads), max(loads)],
        "faults": [as_plain(outcome) for outcome in outcomes],
    }


def _graph(name: str) -> WatchedGraph:
    """Return the lists of tracks of a scenario and its nodes."""
    nodes = [node for node in started_nodes(load_scenario(name), name) if not node.is_display]
    published = [topic for node in nodes for topic in _outputs(node)]
    for tracks in (ACTIVE_TRACKS, PASSIVE_TRACKS, BEARING_TRACKS):
        if tracks in published:
            return WatchedGraph(tracks, tuple(nodes))
    raise ConfigurationError(f"{name} has no node that publishes tracks, so nothing to watch.")


def _outputs(node: NodeDescription) -> tuple[Topic, ...]:
    return (*node.outputs, *node.station_outputs)


_COLUMNS = (
    "fault",
    "times",
    "tracks late, s: median, worst",
    "in time",
    "tracks kept",
    "faults that lost none",
    "lost messages",
    "hole, s",
    "failed",
)


def _table(outcomes: Sequence[Outcome]) -> Table:
    table = Table(title="what came of the faults")
    for heading in _COLUMNS:
        table.add_column(heading)
    groups: Mapping[FaultKind, list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        groups[outcome.fault.kind].append(outcome)
    for kind, group in groups.items():
        table.add_row(kind.value, str(len(group)), *_cells(group))
    return table


def _cells(group: Sequence[Outcome]) -> list[str]:
    """Return what is told of the faults of a kind, behind their number."""
    late = [each.late for each in group if each.late is not None]
    tracks = [each.tracks for each in group if each.tracks is not None and each.tracks.established]
    whole = sum(each.kept == each.established for each in tracks)
    lost = [each.lost_messages for each in group if each.lost_messages is not None]
    holes = [each.hole for each in group if each.hole is not None]
    kept, established = (sum(getattr(t, name) for t in tracks) for name in ("kept", "established"))
    return [
        f"{np.median(late):.1f}, {max(late):.1f}" if late else "",
        f"{sum(each <= IN_TIME for each in late)} of {len(late)}" if late else "",
        f"{kept} of {established}" if tracks else "",
        f"{whole} of {len(tracks)}" if tracks else "",
        str(sum(lost)) if lost else "",
        f"{max(holes):.1f}" if holes else "",
        str(sum(each.failed for each in group)),
    ]
