"""The conditions of the study: scene, what the contacts tell, and what the told tracker knows.

Contacts carry what a sensor knows of itself: errors, resolution, range, threshold and the false
alarms expected of it. The tracker that is told the truth gets everything about targets and clutter
with the contacts, and the motion of the scene as parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.studies.mismatch_contacts.motions import (
    convoy,
    crossing,
    parallel_lanes,
    random_walks,
    turning_paths,
    wharf,
    within,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.scene import (
    OF_THE_DETECTOR,
    UNKNOWN_TO_A_SENSOR,
    Scene,
    detection_probability_of,
    simulate,
)
from sonar_tracking.evaluation.studies.multi_target_clutter import scene as published
from sonar_tracking.motion import Trajectory, Turn
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration

Motion = Callable[[FloatArray, np.random.Generator], FloatArray]
"""From the times of the pings, s, to true states, shape (n_pings, n_targets, 4)."""

SceneMaker = Callable[[np.random.SeedSequence, int], Scene]
"""From the seed of a run and its number of pings to the run."""

NOTHING_BUT_PLACES = (*UNKNOWN_TO_A_SENSOR, *OF_THE_DETECTOR, "amplitude")

STANDARD = ContactSensorConfiguration(
    ping_interval=10.0,
    sound_speed=0.0,
    range_standard_deviation=30.0,
    azimuth_standard_deviation_deg=0.5,
    maximum_range=10_000.0,
    signal_to_noise_ratio_db=10.0,
    detection_probability=0.9,
    clutter_per_ping=10.0,
)
FINE = replace(
    STANDARD,
    ping_interval=2.0,
    range_standard_deviation=4.0,
    azimuth_standard_deviation_deg=0.3,
    maximum_range=2000.0,
)
COARSE = replace(
    STANDARD,
    ping_interval=60.0,
    range_standard_deviation=50.0,
    azimuth_standard_deviation_deg=1.0,
    maximum_range=20_000.0,
)
CONVOY_COARSE = replace(COARSE, ping_interval=10.0, maximum_range=10_000.0)
CONVOY_FINE = replace(STANDARD, range_standard_deviation=10.0, azimuth_standard_deviation_deg=0.2)
BY_THRESHOLD = replace(STANDARD, detection_probability=0.0, clutter_per_ping=0.0)
HEAVY_TAILS = replace(
    BY_THRESHOLD,
    maximum_range=6000.0,
    signal_to_noise_ratio_db=15.0,
    false_alarm_probability=1e-4,
    clutter_shape=1.0,
)
HEAVIER_TAILS = replace(HEAVY_TAILS, clutter_shape=0.5)
HARBOUR = replace(
    STANDARD,
    ping_interval=5.0,
    range_standard_deviation=5.0,
    maximum_range=3000.0,
    clutter="area",
    clutter_per_ping=5.0,
)
WEAK_TARGETS = replace(
    STANDARD,
    signal_to_noise_ratio_db=7.0,
    # The threshold at which targets of 10 dB are detected with 0.9, as by STANDARD.
    detection_probability=float(0.9 ** (11.0 / (1.0 + 10.0**0.7))),
)
WEAKER_TARGETS = replace(BY_THRESHOLD, signal_to_noise_ratio_db=7.0, false_alarm_probability=1e-3)
RARE_DETECTIONS = replace(STANDARD, detection_probability=0.5)

SLOW_TURN = 0.05
FAST_TURN = 0.3 * 9.81
"""Lateral accelerations, m/s^2."""

N_REFLECTORS = 15
WHARF = {
    "distance": 1500.0,
    "n_reflectors": N_REFLECTORS,
    "spacing": 30.0,
    "passing_distance": 20.0,
}
"""m"""

FIRST_PUBLISHED_PING = 100
"""Of the part of the published scene that is taken: two to four targets, one of which turns."""

MEAN_TURN = float(np.radians(135.0))

SMALLEST_TOLD_ACCELERATION = 1e-4
"""m/s^2: that of targets that do not accelerate."""


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
        times = self.sensor.ping_interval * np.arange(n_pings)
        own_ship = self.own_ship.state(times)
        state = self.motion(times, generator)
        state = within(state, own_ship.position, self.sensor.maximum_range)
        common = detection_probability_of(self.sensor)
        each = np.array(self.detection_probability or [common] * state.shape[1])
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


def told_straight(speed: float, acceleration_deviation: float = 0.0) -> ContactTrackerConfiguration:
    """Return the parameters for targets that do not turn.

    Parameters
    ----------
    speed : float
        m/s.
    acceleration_deviation : float
        Per axis, m/s^2.
    """
    return ContactTrackerConfiguration(
        sound_speed=0.0,
        motion="straight",
        acceleration_deviation=max(acceleration_deviation, SMALLEST_TOLD_ACCELERATION),
        initial_speed_deviation=max(speed, 0.1) / float(np.sqrt(2.0)),
    )


def told_turning(
    speed: float, lateral_acceleration: float, interval: float, turns_a_ping: float
) -> ContactTrackerConfiguration:
    """Return the parameters for targets that turn by 90 to 180 degrees.

    Parameters
    ----------
    speed, lateral_acceleration : float
        m/s and m/s^2.
    interval : float
        Between pings, s.
    turns_a_ping : float
        That begin.
    """
    pings_of_a_turn = MEAN_TURN * speed / lateral_acceleration / interval
    return ContactTrackerConfiguration(
        sound_speed=0.0,
        acceleration_deviation=1e-3,
        lateral_acceleration=lateral_acceleration,
        initial_speed_deviation=speed / float(np.sqrt(2.0)),
        turn_probability=turns_a_ping,
        stay_probability=float(np.clip(1.0 - 1.0 / pings_of_a_turn, 0.34, 0.999)),
    )


TOLD_PUBLISHED = ContactTrackerConfiguration(
    sound_speed=0.0,
    acceleration_deviation=published.ACCELERATION_DEVIATION,
    lateral_acceleration=published.LATERAL_ACCELERATION,
    initial_speed_deviation=1.5,
    turn_probability=0.01,
    stay_probability=0.9,
)
"""What the paper of the scene tells, and what was chosen for it."""


def _straight(
    name: str, sensor: ContactSensorConfiguration, speed: float, n_pings: int, cutoff_m: float
) -> Condition:
    return Condition(
        f"{name}, {speed:g} m/s",
        SimulatedScene(sensor, _lanes(sensor, speed)),
        told_straight(speed),
        n_pings,
        cutoff_m,
    )


def _turning(
    name: str,
    sensor: ContactSensorConfiguration,
    motion: tuple[float, float, int],
    n_pings: int,
    cutoff_m: float,
) -> Condition:
    """Return boats of a speed, m/s, that turn with an acceleration, m/s^2, so many times."""
    speed, acceleration, n_turns = motion
    paths = partial(
        turning_paths,
        speed=speed,
        lateral_acceleration=acceleration,
        n_turns=n_turns,
        radius=sensor.maximum_range,
    )
    told = told_turning(speed, acceleration, sensor.ping_interval, n_turns / n_pings)
    return Condition(name, SimulatedScene(sensor, _drawn(paths)), told, n_pings, cutoff_m)


def _drawn(motion: Callable[..., FloatArray]) -> Motion:
    return lambda times, generator: motion(times, generator=generator)


def _lanes(sensor: ContactSensorConfiguration, speed: float) -> Motion:
    return _drawn(partial(parallel_lanes, speed=speed, radius=sensor.maximum_range))


def _round_turn(start: float) -> tuple[Turn, ...]:
    """Return a turn of 360 degrees by a degree a second, from a time, s, on."""
    thirds = np.radians([120.0, -120.0, 0.0])
    return tuple(
        Turn(start + 120.0 * number, float(azimuth), float(np.radians(1.0)))
        for number, azimuth in enumerate(thirds)
    )


STRAIGHT_CONDITIONS = (
    *(
        _straight("straight", STANDARD, v, 80, 200.0)
        for v in (0.0, 2.0, 5.0, 9.0, 12.0, 15.0, 20.0)
    ),
    *(_straight("fine sensor", FINE, v, 100, 50.0) for v in (2.0, 9.0, 15.0)),
    *(_straight("coarse sensor", COARSE, v, 60, 500.0) for v in (2.0, 9.0, 15.0)),
    _straight("ping 2 s", replace(STANDARD, ping_interval=2.0), 5.0, 100, 200.0),
    _straight("ping 60 s", replace(STANDARD, ping_interval=60.0), 5.0, 60, 200.0),
)

MANOEUVRES = (
    _turning("turn of 0.05 m/s2", STANDARD, (5.0, SLOW_TURN, 1), 100, 200.0),
    _turning("turn of 0.05 m/s2, fine sensor", FINE, (5.0, SLOW_TURN, 1), 200, 50.0),
    _turning("turns of 0.3 g", STANDARD, (15.0, FAST_TURN, 3), 100, 200.0),
    _turning("turns of 0.3 g, fine sensor", FINE, (15.0, FAST_TURN, 3), 100, 50.0),
    Condition(
        "random walk of 0.01 m/s2",
        SimulatedScene(
            STANDARD,
            _drawn(partial(random_walks, speed=3.0, acceleration_deviation=0.01, radius=10_000.0)),
        ),
        told_straight(3.0, 0.01),
    ),
    Condition(
        "own ship turns",
        SimulatedScene(
            STANDARD,
            _lanes(STANDARD, 5.0),
            Trajectory((-1300.0, 0.0), 0.0, 6.0, _round_turn(220.0)),
        ),
        told_straight(5.0),
    ),
)

DETECTION_CONDITIONS = (
    Condition(
        "P_D 0.5, told 0.9",
        SimulatedScene(RARE_DETECTIONS, _lanes(RARE_DETECTIONS, 2.0)),
        told_straight(2.0),
        claimed=MappingProxyType({"detection_probability": 0.9}),
    ),
    Condition(
        "P_D 0.5, not told",
        SimulatedScene(RARE_DETECTIONS, _lanes(RARE_DETECTIONS, 2.0)),
        told_straight(2.0),
    ),
    *(
        Condition(
            f"environment {number}, nothing told",
            partial(published_scene, number),
            TOLD_PUBLISHED,
            hidden=NOTHING_BUT_PLACES,
        )
        for number in (1, 2)
    ),
    *(
        Condition(
            f"K-distributed clutter, shape {sensor.clutter_shape:g}",
            SimulatedScene(sensor, _lanes(sensor, 5.0)),
            # The law of amplitudes is exponential: of clutter of another law it is wrong.
            replace(told_straight(5.0), outlier_share=1.0),
            60,
            claimed=MappingProxyType({"false_alarm_probability": sensor.false_alarm_probability}),
        )
        for sensor in (HEAVY_TAILS, HEAVIER_TAILS)
    ),
    *(
        Condition(name, SimulatedScene(sensor, _lanes(sensor, 5.0)), told_straight(5.0))
        for name, sensor in (("SNR 7 dB", WEAK_TARGETS), ("SNR 7 dB, P_F 0.001", WEAKER_TARGETS))
    ),
)

CROWDS = (
    *(
        Condition(
            f"convoy, {name} sensor",
            SimulatedScene(
                sensor,
                _drawn(partial(convoy, speed=6.0, spacing=200.0, distance=5000.0, n_ships=5)),
            ),
            told_straight(6.0),
        )
        for name, sensor in (("coarse", CONVOY_COARSE), ("fine", CONVOY_FINE))
    ),
    Condition(
        "ten ships cross",
        SimulatedScene(STANDARD, _drawn(partial(crossing, speed=4.0, distance=5000.0, n_ships=10))),
        told_straight(4.0),
    ),
    *(
        Condition(
            name,
            SimulatedScene(
                HARBOUR,
                _drawn(partial(wharf, boat_speed=speed, **WHARF)),
                Trajectory((0.0, 0.0), 0.5 * np.pi, 0.5),
                (*[reflector_detection] * N_REFLECTORS, HARBOUR.detection_probability),
            ),
            # Nearly everything is at rest: the root mean square of all speeds.
            told_straight(speed / np.sqrt(N_REFLECTORS + 1), 1e-3),
            cutoff_m=30.0,
            hidden=NOTHING_BUT_PLACES,
        )
        for name, speed, reflector_detection in (
            ("wharf", 3.0, 0.95),
            ("wharf, reflectors fade", 5.0, 0.8),
        )
    ),
)

CONDITIONS = {
    condition.name: condition
    for condition in (*STRAIGHT_CONDITIONS, *MANOEUVRES, *DETECTION_CONDITIONS, *CROWDS)
}
"""By name, in the order of the tables."""
