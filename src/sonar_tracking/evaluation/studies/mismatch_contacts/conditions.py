"""The conditions of the study: scene, what the contacts tell, and what the told tracker knows.

Contacts carry what a sensor knows of itself: errors, resolution, range, threshold and the false
alarms expected of it. The tracker that is told the truth gets everything about targets and clutter
with the contacts, and the motion of the scene as parameters.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType

import numpy as np

from sonar_tracking.evaluation.studies.mismatch_contacts.condition import (
    Condition,
    Motion,
    SimulatedScene,
    drawn,
    published_scene,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.motions import (
    convoy,
    crossing,
    parallel_lanes,
    random_walks,
    turning_paths,
    wharf,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.scene import (
    OF_THE_DETECTOR,
    UNKNOWN_TO_A_SENSOR,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.sensors import (
    COARSE,
    CONVOY_COARSE,
    CONVOY_FINE,
    FINE,
    HARBOUR,
    HEAVIER_TAILS,
    HEAVY_TAILS,
    RARE_DETECTIONS,
    STANDARD,
    WEAK_TARGETS,
    WEAKER_TARGETS,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.told_parameters import (
    TOLD_PUBLISHED,
    told_straight,
    told_turning,
)
from sonar_tracking.motion import Trajectory, Turn
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration

NOTHING_BUT_PLACES = (*UNKNOWN_TO_A_SENSOR, *OF_THE_DETECTOR, "amplitude")

SLOW_TURN = 0.05
FAST_TURN = 0.3 * 9.81
"""Lateral accelerations, m/s^2."""

N_REFLECTORS = 15


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
    return Condition(name, SimulatedScene(sensor, drawn(paths)), told, n_pings, cutoff_m)


def _lanes(sensor: ContactSensorConfiguration, speed: float) -> Motion:
    return drawn(partial(parallel_lanes, speed=speed, radius=sensor.maximum_range))


def _round_turn(start: float) -> tuple[Turn, ...]:
    """Return a turn of 360 degrees by a degree a second, from a time, s, on."""
    thirds = np.radians([120.0, -120.0, 0.0])
    return tuple(
        Turn(start + 120.0 * number, float(azimuth), float(np.radians(1.0)))
        for number, azimuth in enumerate(thirds)
    )


def _past_a_wharf(boat_speed: float) -> Motion:
    return drawn(
        partial(
            wharf,
            boat_speed=boat_speed,
            centre=(1000.0, 1500.0),
            n_reflectors=N_REFLECTORS,
            spacing=30.0,
            passing_distance=20.0,
        )
    )


STRAIGHT_CONDITIONS = (
    *(
        _straight("straight", STANDARD, v, 100, 200.0)
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
            drawn(partial(random_walks, speed=3.0, acceleration_deviation=0.01, radius=10_000.0)),
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
                drawn(partial(convoy, speed=6.0, spacing=200.0, distance=5000.0, n_ships=5)),
            ),
            told_straight(6.0),
        )
        for name, sensor in (("coarse", CONVOY_COARSE), ("fine", CONVOY_FINE))
    ),
    Condition(
        "ten ships cross",
        SimulatedScene(STANDARD, drawn(partial(crossing, speed=4.0, distance=5000.0, n_ships=10))),
        told_straight(4.0),
    ),
    *(
        Condition(
            name,
            SimulatedScene(
                HARBOUR,
                _past_a_wharf(speed),
                Trajectory((0.0, 0.0), 0.5 * np.pi, 0.5),
                (*[reflector_detection] * N_REFLECTORS, HARBOUR.detection_probability),
            ),
            # Nearly everything is at rest: the root mean square of all speeds.
            told_straight(speed / (N_REFLECTORS + 1) ** 0.5, 1e-3),
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
