"""Which graphs the bench runs. No ROS."""

from __future__ import annotations

from dataclasses import dataclass, replace

from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    PASSIVE_TRACKS,
    Topic,
)
from sonar_tracking.simulation.scenarios.array_configuration import ArrayConfiguration
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

LATENCY_PERIOD = 0.1
"""Between estimates where their latency is measured, s: 400 in 40 s."""

LARGE = {256: 300_000.0, 512: 600_000.0}
"""Elements, and frequency at which the narrow band suits their aperture, Hz."""


@dataclass(frozen=True)
class GraphCase:
    """A run of the bench.

    Attributes
    ----------
    name : str
        In the tables.
    scenario : Scenario
        What is run.
    tracks : Topic
        Lists of tracks.
    rate : str
        As ``run`` takes it.
    recorded : bool
        Into a bag, which is replayed afterwards.
    has_costs : bool
        Whether the mathematics of its nodes is measured for itself.
    """

    name: str
    scenario: Scenario
    tracks: Topic
    rate: str = "max"
    recorded: bool = False
    has_costs: bool = False


def graph_cases() -> tuple[GraphCase, ...]:
    """Return the runs, in order."""
    short, long = load_scenario("doa_fusion"), load_scenario("doa_fusion_long")
    active, tonals = load_scenario("active"), load_scenario("tonals")
    often = {**short.nodes["subspace_estimator"], "period": LATENCY_PERIOD}
    fast = replace(short, nodes={**short.nodes, "subspace_estimator": often})
    long = replace(long, duration=300.0)
    return (
        GraphCase("doa_fusion at rate 1, 10 estimates/s", fast, BEARING_TRACKS, "1"),
        GraphCase("doa_fusion_long, 300 s", long, BEARING_TRACKS, recorded=True, has_costs=True),
        GraphCase("active, 1200 s", active, ACTIVE_TRACKS, has_costs=True),
        *(
            GraphCase(f"{size} elements, 30 s", _large(long, size), BEARING_TRACKS, has_costs=True)
            for size in LARGE
        ),
        GraphCase("tonals, 60 s", replace(tonals, duration=60.0), PASSIVE_TRACKS),
    )


def _large(scenario: Scenario, size: int) -> Scenario:
    """Return a scenario with a large array, short by its frequency, and default parameters."""
    return replace(
        scenario,
        name=f"large_{size}",
        array=ArrayConfiguration(n_elements=size, center_frequency=LARGE[size]),
        duration=30.0,
        nodes={name: {} for name in scenario.nodes},
    )
