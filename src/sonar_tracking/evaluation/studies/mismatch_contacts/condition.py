"""What a condition of the study consists of, and what makes its runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.studies.mismatch_contacts.motions import within
from sonar_tracking.evaluation.studies.mismatch_contacts.scene import (
    UNKNOWN_TO_A_SENSOR,
    Scene,
    detection_probability_of,
    simulate,
)
from sonar_tracking.evaluation.studies.multi_target_clutter import scene as published
from sonar_tracking.motion import Trajectory
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration

Motion = Callable[[FloatArray, np.random.Generator], FloatArray]
"""From the times of the pings, s, to true states, shape (n_pings, n_targets, 4)."""

SceneMaker = Callable[[np.random.SeedSequence, int], Scene]
"""From the seed of a run and its number of pings to the run."""

FIRST_PUBLISHED_PING = 100
"""Of the part of the published scene that is taken: two to four targets, one of which turns."""


@dataclass(frozen=True)
class Condition:
    """One condition of the study.

    Attributes
    ----------
    name : str
        In tables.
    scene : callable
        Makes a run.
    told : ContactTrackerConfiguration
        Parameters of the tracker that is told the truth.
    n_pings : int
        Of a run.
    cutoff_m : float
        Distance from which on a track is none of a target, m.
    hidden : tuple of str
        Fields of the contacts that the default tracker does not get.
    claimed : mapping of str to float
        Fields of the contacts with what they claim instead of the truth.
    """

    name: str
    scene: SceneMaker
    told: ContactTrackerConfiguration
    n_pings: int = 100
    cutoff_m: float = 200.0
    hidden: tuple[str, ...] = UNKNOWN_TO_A_SENSOR
    claimed: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True)
class SimulatedScene:
    """Makes runs of one kind.

    Attributes
    ----------
    sensor : ContactSensorConfiguration
        What looks at the targets.
    motion : callable
        Moves them.
    own_ship : Trajectory
        Of the sensor.
    detection_probability : tuple of float
        Of each target; empty = that of the sensor.
    """

    sensor: ContactSensorConfiguration
    motion: Motion
    own_ship: Trajectory = field(default_factory=lambda: Trajectory((0.0, 0.0), 0.0, 0.0))
    detection_probability: tuple[float, ...] = ()

    def __call__(self, seed: np.random.SeedSequence, n_pings: int) -> Scene:
        """Return the run of a seed."""
        generator = np.random.default_rng(seed)
        times = self.sensor.ping_interval * np.arange(n_pings, dtype=np.float64)
        own_ship = self.own_ship.state(times)
        state = self.motion(times, generator)
        state = within(state, own_ship.position, self.sensor.maximum_range)
        common = detection_probability_of(self.sensor)
        each = np.array(self.detection_probability or [common] * state.shape[1], np.float64)
        return simulate(self.sensor, own_ship, state, each, generator)


def published_scene(environment: int, seed: np.random.SeedSequence, n_pings: int) -> Scene:
    """Return a part of the scene of the study multi-target-clutter.

    Parameters
    ----------
    environment : int
        1 or 2.
    seed : numpy.random.SeedSequence
        Of the run.
    n_pings : int
        From ping 100 of the scene on.
    """
    options = published.SceneOptions(environment)
    first = FIRST_PUBLISHED_PING
    pings = published.simulate_scene(options, seed, first + n_pings)[first:]
    state = np.full((n_pings, len(published.TARGETS), 4), np.nan)
    for number, ping in enumerate(pings):
        state[number, ping.target_id - 1] = ping.state
    return Scene(tuple(ping.contacts for ping in pings), state)


def drawn(motion: Callable[..., FloatArray]) -> Motion:
    """Return a motion from a function that takes its generator by name."""
    return lambda times, generator: motion(times, generator=generator)
