"""Scenarios of stations, each run once through target motion analysis for all tests of a worker."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from sonar_tracking.evaluation.offline.offline_tma_chain import (
    OfflineTmaRun,
    run_offline_tma_chain,
)
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

DURATIONS = {"tma": 720.0, "cross_fix": 320.0}
"""Of each scenario, s: its targets are held for long enough by then to be known with hindsight."""


def offline_tma_run(name: str, seed: int | None = None) -> OfflineTmaRun:
    """Return what the chain takes and gives in a scenario, with its own seed or another."""
    return _run(name, seed)


@cache
def _run(name: str, seed: int | None) -> OfflineTmaRun:
    scenario = replace(load_scenario(name), duration=DURATIONS[name])
    return run_offline_tma_chain(scenario if seed is None else replace(scenario, seed=seed))
