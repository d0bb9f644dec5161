"""Runs of the multi-target-clutter study: all trackers on the same contacts, and scores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.metrics.identity_score import (
    IdentityScore,
    ScoredPeriod,
    score_identities,
)
from sonar_tracking.evaluation.metrics.ospa_gospa import Assignment, assign, gospa, ospa
from sonar_tracking.evaluation.monte_carlo.tracked_runs import track_runs
from sonar_tracking.evaluation.studies.multi_target_clutter.clutter_bound import position_bound
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    N_PINGS,
    PING_INTERVAL,
    SceneOptions,
    simulate_scene,
)
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.contacts import ContactTrackerUpdate
from sonar_tracking.records.time import seconds
from sonar_tracking.simulation.sensors.contact_simulation import SimulatedPing

CUTOFF = 200.0
ORDER = 2.0

SETTLED_PINGS = 20
"""Age from which an error counts as settled."""


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
class SystemRun:
    """What one tracker did in one run.

    Attributes
    ----------
    count : ndarray, shape (n_pings,)
        Count of targets it believes in; the mass of a density.
    n_estimates : ndarray, shape (n_pings,)
        Count of confirmed tracks.
    ospa, gospa : ndarray, shape (n_pings,)
        m, cut-off 200 m, order 2.
    square_error : ndarray, shape (n_held,)
        Of all assigned pairs, m^2.
    settled_square_error : ndarray, shape (n_settled,)
        Of tracks older than 20 pings, m^2.
    identities : IdentityScore
        Of no meaning for trackers without identities.
    seconds : float
        Processor time a ping of a tracker by itself, s; NaN = not measured.
    estimates : tuple of ndarray, shape (n_estimates, 3)
        Identity, x and y at each ping, m.
    """

    count: FloatArray
    n_estimates: FloatArray
    ospa: FloatArray
    gospa: FloatArray
    square_error: FloatArray
    settled_square_error: FloatArray
    identities: IdentityScore
    seconds: float
    estimates: tuple[FloatArray, ...]


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
    systems = {name: _system_runs(c, scenes, task.timed) for name, c in task.systems.items()}
    return tuple(
        ClutterRun(
            condition=task.condition,
            true_count=np.array([len(ping.target_id) for ping in pings], dtype=np.float64),
            truth=tuple(_identified(ping.target_id, ping.state) for ping in pings),
            systems={name: runs[number] for name, runs in systems.items()},
            bound_square_error=position_bound(task.options, pings, SETTLED_PINGS),
        )
        for number, pings in enumerate(scenes)
    )


def _system_runs(
    configuration: ContactTrackerConfiguration,
    scenes: Sequence[Sequence[SimulatedPing]],
    timed: bool,
) -> list[SystemRun]:
    tracked = track_runs(
        configuration, [[ping.contacts for ping in pings] for pings in scenes], timed
    )
    return [
        _scored_run(pings, updates, tracked.seconds)
        for pings, updates in zip(scenes, tracked.updates, strict=True)
    ]


def _scored_run(
    pings: Sequence[SimulatedPing], updates: Sequence[ContactTrackerUpdate], seconds: float
) -> SystemRun:
    scores = [_Scored.of(ping, update) for ping, update in zip(pings, updates, strict=True)]
    first_seen: dict[int, int] = {}
    for ping in pings:
        for target in ping.target_id:
            first_seen.setdefault(int(target), ping.contacts.stamp)
    return SystemRun(
        count=np.array([update.target_count for update in updates]),
        n_estimates=np.array([s.assignment.n_estimates for s in scores], dtype=np.float64),
        ospa=np.array([ospa(s.assignment, CUTOFF, ORDER) for s in scores]),
        gospa=np.array([gospa(s.assignment, CUTOFF, ORDER) for s in scores]),
        square_error=np.concatenate([s.square_error for s in scores]),
        settled_square_error=np.concatenate([s.square_error[s.settled] for s in scores]),
        identities=score_identities([s.period for s in scores], PING_INTERVAL, first_seen),
        seconds=seconds,
        estimates=tuple(s.estimates for s in scores),
    )


@dataclass(frozen=True)
class _Scored:
    """One ping of one tracker against the truth."""

    assignment: Assignment
    period: ScoredPeriod
    square_error: FloatArray
    settled: BoolArray
    estimates: FloatArray

    @classmethod
    def of(cls, ping: SimulatedPing, update: ContactTrackerUpdate) -> _Scored:
        tracks = update.tracks
        shown = tracks.established
        identity, state = tracks.id[shown], tracks.state[shown]
        # Stamps in seconds are rounded to a fraction of a microsecond; pings are whole numbers.
        age = np.round((seconds(tracks.stamp) - tracks.initiated[shown]) / PING_INTERVAL, 3)
        separation = ping.state[:, None, :2] - state[None, :, :2]
        distance = np.hypot(separation[..., 0], separation[..., 1])
        assignment = assign(distance, CUTOFF, ORDER)
        pairs = (assignment.truths, assignment.estimates)
        near = np.any(distance < CUTOFF, axis=0)
        period = ScoredPeriod(
            stamp=tracks.stamp,
            truth_ids=tuple(ping.target_id.tolist()),
            track_ids=tuple(identity.tolist()),
            held={
                int(ping.target_id[row]): int(identity[column])
                for row, column in zip(*pairs, strict=True)
            },
            near=frozenset(identity[near].tolist()),
        )
        settled = age[assignment.estimates] >= SETTLED_PINGS
        estimates = _identified(identity, state)
        return cls(assignment, period, distance[pairs] ** 2, settled, estimates)


def _identified(identity: NDArray[Any], state: FloatArray) -> FloatArray:
    return np.column_stack([identity.astype(np.float64), state[:, :2]])
