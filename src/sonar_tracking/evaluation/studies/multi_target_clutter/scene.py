"""Six targets that come, turn and go: the scene of Kim and Song (2007) in three environments.

Environments 1 and 2 are the paper's: probability of detection, signal-to-noise ratio and clutter
are three independent inputs, clutter is uniform per square metre. Environment 3 is for thresholds
in the gates: the detector reports everything above a low threshold, uniform per resolution cell.
The paper's scene is instantaneous: sound takes longer to 10 km and back than the 10 s between
pings.

References
----------
Kim, Song (2007), section 4, Tables 1 and 2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.active.tracks.motion_modes import turn_matrices
from sonar_tracking.motion import KinematicState, Trajectory
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.sensors.contact_simulation import (
    ContactSimulation,
    ContactTarget,
    SimulatedPing,
)

N_PINGS = 450
PING_INTERVAL = 10.0
MAXIMUM_RANGE = 10_000.0
EPOCH = 1_767_225_600_000_000_000
LATERAL_ACCELERATION = 0.01
ACCELERATION_DEVIATION = 0.0015
TURN_PINGS = 20

TARGETS = (
    (1, 0, 200, (-3000.0, -5000.0, 1.5, 1.0)),
    (2, 100, 350, (0.0, 5000.0, 1.0, -1.0)),
    (3, 150, 400, (-5000.0, 5000.0, 0.5, -1.0)),
    (4, 250, 450, (-1000.0, 1000.0, 0.75, -1.0)),
    (5, 300, 450, (4000.0, 4000.0, -1.5, -1.5)),
    (6, 150, 350, (4000.0, 0.0, 0.0, -1.5)),
)
"""Identity, first and last ping, and state at the first one (m, m/s)."""


def _sensor(**values: float | str) -> ContactSensorConfiguration:
    common: dict[str, float | str] = {
        "ping_interval": PING_INTERVAL,
        "sound_speed": 0.0,
        "maximum_range": MAXIMUM_RANGE,
    }
    return ContactSensorConfiguration(**{**common, **values})  # type: ignore[arg-type]


ENVIRONMENTS = {
    1: _sensor(
        signal_to_noise_ratio_db=10.0,
        detection_probability=0.9,
        clutter="area",
        clutter_per_ping=10.0,
    ),
    2: _sensor(
        signal_to_noise_ratio_db=float(10.0 * np.log10(5.0)),
        detection_probability=0.6,
        clutter="area",
        clutter_per_ping=50.0,
    ),
    3: _sensor(signal_to_noise_ratio_db=10.0, false_alarm_probability=0.03, clutter="cell"),
}
"""Sensor of each environment."""


class SampledPath:
    """Motion given at the pings, straight in between.

    Parameters
    ----------
    first_time : float
        Of the first sample, s.
    samples : ndarray, shape (n, 4)
        x, y, vx, vy at intervals of a ping.
    """

    def __init__(self, first_time: float, samples: FloatArray) -> None:
        self._first_time = first_time
        self._samples = samples

    def state(self, times: ArrayLike) -> KinematicState:
        """Return the state at the given times, shape (...), s."""
        place = (np.asarray(times, dtype=np.float64) - self._first_time) / PING_INTERVAL
        row = np.clip(np.floor(place + 1e-9), 0, len(self._samples) - 1).astype(int)
        elapsed = (place - row) * PING_INTERVAL
        sample = self._samples[row]
        velocity = sample[..., 2:]
        azimuth = np.arctan2(velocity[..., 1], velocity[..., 0])
        position = sample[..., :2] + np.asarray(elapsed)[..., None] * velocity
        return KinematicState(position, velocity, azimuth, np.zeros_like(azimuth))


@dataclass(frozen=True)
class SceneOptions:
    """What of the scene may be left out.

    Attributes
    ----------
    environment : int
        1, 2 or 3.
    turns : bool
        Whether the targets turn in mid-life.
    clutter_per_ping : float
        Other than the environment's; 0 = the environment's.
    """

    environment: int
    turns: bool = True
    clutter_per_ping: float = 0.0


def turning(first: int, last: int, ping: int) -> bool:
    """Return whether a target alive between these pings turns after the given one."""
    start = (first + last) // 2 - TURN_PINGS // 2
    return start <= ping < start + TURN_PINGS


def make_targets(turns: bool, generator: np.random.Generator) -> tuple[ContactTarget, ...]:
    """Return the six targets with their random accelerations.

    Parameters
    ----------
    turns : bool
        Odd identities turn left, even ones right, for 20 pings in mid-life.
    generator : numpy.random.Generator
        Of the accelerations.
    """
    targets = []
    gain = np.kron(np.array([[0.5 * PING_INTERVAL**2], [PING_INTERVAL]]), np.eye(2))
    straight_on = turn_matrices(np.array(0.0), PING_INTERVAL)
    for identity, first, last, initial in TARGETS:
        samples = [np.array(initial)]
        for ping in range(first, last):
            state = samples[-1]
            matrix = straight_on
            if turns and turning(first, last, ping):
                sign = 1.0 if identity % 2 else -1.0
                rate = sign * LATERAL_ACCELERATION / float(np.hypot(*state[2:]))
                matrix = turn_matrices(np.array(rate), PING_INTERVAL)
            noise = ACCELERATION_DEVIATION * generator.standard_normal(2)
            samples.append(matrix @ state + gain @ noise)
        path = SampledPath(first * PING_INTERVAL, np.array(samples))
        targets.append(ContactTarget(identity, path, first * PING_INTERVAL, last * PING_INTERVAL))
    return tuple(targets)


def simulate_scene(
    options: SceneOptions, seed: np.random.SeedSequence, n_pings: int = N_PINGS
) -> tuple[SimulatedPing, ...]:
    """Return the pings of one run.

    Parameters
    ----------
    options : SceneOptions
        Environment and what of it.
    seed : numpy.random.SeedSequence
        Of the run.
    n_pings : int
        From the first one on.
    """
    motion, detection = seed.spawn(2)
    sensor = ENVIRONMENTS[options.environment]
    if options.clutter_per_ping > 0.0:
        sensor = replace(sensor, clutter_per_ping=options.clutter_per_ping)
    simulation = ContactSimulation(
        sensor,
        Trajectory((0.0, 0.0), 0.0, 0.0),
        make_targets(options.turns, np.random.default_rng(motion)),
        np.random.default_rng(detection),
        EPOCH,
    )
    return tuple(simulation.ping(number) for number in range(n_pings))
