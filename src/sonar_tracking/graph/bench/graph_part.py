"""The part of the bench that runs whole graphs, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from sonar_tracking.evaluation.bench.bench import PartDefinition, Step
from sonar_tracking.evaluation.bench.machine import Machine
from sonar_tracking.evaluation.bench.stage_costs import stage_costs
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.graph.bench.graph_cases import GraphCase, graph_cases
from sonar_tracking.graph.bench.graph_rows import GRAPH_LAYOUTS, graph_rows
from sonar_tracking.graph.bench.measured_run import measured_run
from sonar_tracking.simulation.scenarios.scenario_mapping import scenario_to_yaml

RECORDING, REPLAYING = ", recording", ", replaying"


def graph_steps(_: Machine) -> Sequence[Step]:
    """Return a step for each run, and one for each replay of what was recorded."""
    runs = _Runs()
    steps = []
    for case in graph_cases():
        steps.append(Step(case.name, partial(runs.run, case)))
        if case.recorded:
            steps.append(Step(f"{case.name}{REPLAYING}", partial(runs.replay, case)))
    return steps


class _Runs:
    """Runs the cases in a folder of their own, which goes with them."""

    def __init__(self) -> None:
        self._temporary = TemporaryDirectory(prefix="sonar_tracking-bench-")
        self._costs: dict[str, dict[str, float]] = {}

    def run(self, case: GraphCase) -> tuple[StudyRow, ...]:
        """Run a case and return its rows."""
        folder = self._folder("run")
        scenario = folder / "scenario.yaml"
        scenario.write_text(scenario_to_yaml(case.scenario), encoding="utf-8")
        costs = stage_costs(case.scenario) if case.has_costs else {}
        self._costs[case.name] = costs
        options = ["--record", str(self._bag(case))] if case.recorded else []
        arguments = ["run", str(scenario), "--rate", case.rate, *options]
        measured = measured_run(arguments, case.tracks, folder)
        suffix = RECORDING if case.recorded else ""
        return tuple(graph_rows(f"{case.name}{suffix}", measured, costs, case.rate != "max"))

    def replay(self, case: GraphCase) -> tuple[StudyRow, ...]:
        """Replay what was recorded of a case and return the rows."""
        arguments = ["replay", str(self._bag(case)), "--rate", "max"]
        measured = measured_run(arguments, case.tracks, self._folder("replay"))
        costs = self._costs[case.name]
        return tuple(graph_rows(f"{case.name}{REPLAYING}", measured, costs, False))

    def _bag(self, case: GraphCase) -> Path:
        return Path(self._temporary.name) / f"{case.scenario.name}_bag"

    def _folder(self, verb: str) -> Path:
        place = Path(self._temporary.name)
        folder = place / f"{verb}_{len(list(place.iterdir()))}"
        folder.mkdir()
        return folder


GRAPH = PartDefinition("graph", graph_steps, GRAPH_LAYOUTS)
