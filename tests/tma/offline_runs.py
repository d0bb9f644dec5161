"""Scenarios of stations, each run once through target motion analysis for all tests of a worker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

from sonar_tracking.evaluation.offline.offline_tma_chain import (
    OfflineTmaRun,
    run_offline_tma_chains,
)
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

DURATIONS = {"tma": 720.0, "cross_fix": 320.0}
"""Of each scenario, s: its targets are held for long enough by then to be known with hindsight."""


SEEDS: dict[str, tuple[int | None, ...]] = {"tma": (None, 3), "cross_fix": (None,)}
"""Of the runs of each, which are followed together; None = its own."""


def offline_tma_run(name: str, seed: int | None = None) -> OfflineTmaRun:
    """Return what the chain takes and gives in a scenario, with its own seed or another."""
    return _runs(name)[SEEDS[name].index(seed)]


@cache
def _runs(name: str) -> Sequence[OfflineTmaRun]:
    scenario = replace(load_scenario(name), duration=DURATIONS[name])
    return run_offline_tma_chains(
        [scenario if seed is None else replace(scenario, seed=seed) for seed in SEEDS[name]]
    )
