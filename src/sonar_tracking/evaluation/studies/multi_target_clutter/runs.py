"""Runs of the multi-target-clutter study: all trackers on the same contacts, and scores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.monte_carlo.tracked_runs import track_runs
from sonar_tracking.evaluation.studies.multi_target_clutter.clutter_bound import position_bounds
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    N_PINGS,
    SceneOptions,
    simulate_scene,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.system_run import (
    SETTLED_PINGS,
    SystemRun,
    identified,
    scored_run,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.contact_simulation import SimulatedPing

SYSTEMS_AT_ONCE = 4
"""Trackers that go through the pings together: more of them would save little, and what each says
of all pings is kept."""


@dataclass(frozen=True)
class ClutterTask:
    """Runs in one environment that are tracked together.

    Attributes
    ----------
    condition : str
        Name of the environment in tables.
    options : SceneOptions
        The scene.
    systems : mapping of str to ContactTrackerConfiguration
        Trackers by name.
    seeds : tuple of numpy.random.SeedSequence
        One a run.
    n_pings : int
        Length of a run.
    timed : bool
        Whether processor times are measured, too.
    """

    condition: str
    options: SceneOptions
    systems: Mapping[str, ContactTrackerConfiguration]
    seeds: tuple[np.random.SeedSequence, ...]
    n_pings: int = N_PINGS
    timed: bool = False


@dataclass(frozen=True)
class ClutterRun:
    """What all trackers did in one run.

    Attributes
    ----------
    condition : str
        Name of the environment.
    true_count : ndarray, shape (n_pings,)
        Count of targets present.
    truth : tuple of ndarray, shape (n_targets, 3)
        Identity, x and y at each ping, m.
    systems : mapping of str to SystemRun
        By name.
    bound_square_error : ndarray, shape (n_settled,)
        What no tracker can beat, m^2.
    """

    condition: str
    true_count: FloatArray
    truth: tuple[FloatArray, ...]
    systems: Mapping[str, SystemRun]
    bound_square_error: FloatArray


def clutter_runs(task: ClutterTask) -> tuple[ClutterRun, ...]:
    """Simulate runs and track them with all systems."""
    scenes = [simulate_scene(task.options, seed, task.n_pings) for seed in task.seeds]
    systems = _system_runs(task.systems, scenes, task.timed)
    bounds = position_bounds(task.options, scenes, SETTLED_PINGS)
    return tuple(
        ClutterRun(
            condition=task.condition,
            true_count=np.array([len(ping.target_id) for ping in pings], dtype=np.float64),
            truth=tuple(identified(ping.target_id, ping.state) for ping in pings),
            systems={name: runs[number] for name, runs in systems.items()},
            bound_square_error=bounds[number],
        )
        for number, pings in enumerate(scenes)
    )


def _system_runs(
    configurations: Mapping[str, ContactTrackerConfiguration],
    scenes: Sequence[Sequence[SimulatedPing]],
    timed: bool,
) -> dict[str, list[SystemRun]]:
    contacts = [[ping.contacts for ping in pings] for pings in scenes]
    names, scored = list(configurations), {}
    for first in range(0, len(names), SYSTEMS_AT_ONCE):
        own = names[first : first + SYSTEMS_AT_ONCE]
        kinds = track_runs([configurations[name] for name in own], contacts, timed)
        for name, tracked in zip(own, kinds, strict=True):
            scored[name] = [
                scored_run(pings, updates, tracked.seconds)
                for pings, updates in zip(scenes, tracked.updates, strict=True)
            ]
    return scored
