"""Processor time that the mathematics of each node takes for the data of a scenario.

The same stage objects as in the nodes, fed with the same data in one process: what a node takes
beyond it goes into messages. The orchestration scores what it hears.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TypeVar

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_defaults import (
    ContactDefaultsConfiguration,
    with_defaults,
)
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.metrics.bearing_score import OnlineBearingScore
from sonar_tracking.evaluation.metrics.position_score import OnlinePositionScore
from sonar_tracking.evaluation.metrics.position_truth import truth_as_tracks
from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.evaluation.offline.offline_contact_chain import TRACKER
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation

Result = TypeVar("Result")

ORCHESTRATION = "orchestration"
"""The process that starts the nodes, and scores their tracks."""

SAMPLED_SECONDS = 60.0
"""Of an array's data: the costs of the rest are taken to be the same."""


class _Clock:
    """Adds up processor time by name, s."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def timed(self, name: str, call: Callable[[], Result]) -> Result:
        """Return what a call returns, and add up its time."""
        started = time.process_time()
        result = call()
        self.seconds[name] = self.seconds.get(name, 0.0) + time.process_time() - started
        return result


def stage_costs(scenario: Scenario) -> dict[str, float]:
    """Return the processor time of the mathematics of each node, s, by its name.

    Parameters
    ----------
    scenario : Scenario
        With a narrowband array or an active sonar.
    """
    if scenario.active_sonar is not None:
        return _contact_costs(scenario)
    seconds = min(scenario.duration, SAMPLED_SECONDS)
    costs = _bearing_costs(replace(scenario, duration=seconds))
    return {name: cost * scenario.duration / seconds for name, cost in costs.items()}


def _bearing_costs(scenario: Scenario) -> dict[str, float]:
    clock = _Clock()
    where = scenario.name
    given = [scenario.nodes.get(name, {}) for name in ("subspace_estimator", "bearing_tracker")]
    estimator = SubspaceStage(stage_configuration(SubspaceConfiguration, given[0], where))
    tracker = BearingTrackerStage(stage_configuration(BearingTrackerConfiguration, given[1], where))
    simulation, score = ArraySimulation(scenario), OnlineBearingScore()
    while (block := clock.timed("array_simulator", simulation.next_block)) is not None:
        clock.timed(ORCHESTRATION, partial(score.add_truth, block.truth_bearings))
        found = clock.timed("subspace_estimator", partial(estimator.update, block.snapshots))
        for each in found.estimates:
            tracked = clock.timed("bearing_tracker", partial(tracker.update, each))
            clock.timed(ORCHESTRATION, partial(score.add_tracks, tracked.tracks))
    return clock.seconds


def _contact_costs(scenario: Scenario) -> dict[str, float]:
    clock = _Clock()
    given = scenario.nodes.get(TRACKER, {})
    defaults = stage_configuration(ContactDefaultsConfiguration, given, scenario.name)
    tracker = make_contact_tracker(
        stage_configuration(ContactTrackerConfiguration, given, scenario.name)
    )
    pings, score = iter(ActiveSonarSimulation(scenario)), OnlinePositionScore()
    while (ping := clock.timed("contact_simulator", lambda: next(pings, None))) is not None:
        clock.timed(ORCHESTRATION, partial(score.add_truth, truth_as_tracks(ping.truth_tracks)))
        contacts = with_defaults(ping.contacts, defaults)
        tracked = clock.timed(TRACKER, partial(tracker.update, contacts))
        clock.timed(ORCHESTRATION, partial(score.add_tracks, tracked.tracks))
    return clock.seconds
