"""The scenes of the study: four ships around own ship, a sonar and a line array."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import scenario_from_mapping

ACCELERATION = 0.05
"""Of the ships, new each second, standard deviation per axis, m/s^2."""

DURATION = 900.0
"""Of a run, s."""

LOSS = (300.0, 600.0)
"""From when until when a source is lost, s."""

NEVER = (np.inf, np.inf)

NEAREST, FARTHEST = 1500.0, 4500.0
"""Ranges of the ships from own ship in the middle of a run, m."""

MIDDLE = np.array([1250.0, 1950.0])
"""Where own ship is then, m."""


@dataclass(frozen=True)
class Condition:
    """What is special about a scene.

    Attributes
    ----------
    misalignment_deg : float
        By how much the array is turned anticlockwise from what its data tell.
    false_alarm_probability : float
        Of a cell of the sonar.
    silent_sonar, silent_array : tuple of two float
        From when until when either is not heard of, s.
    crossing : bool
        Two pairs of ships meet, 300 and 450 s after the beginning.
    moored : bool
        A moored station with true bearings listens, too.
    """

    misalignment_deg: float = 0.0
    false_alarm_probability: float = 1e-4
    silent_sonar: tuple[float, float] = NEVER
    silent_array: tuple[float, float] = NEVER
    crossing: bool = False
    moored: bool = False

    @property
    def heard(self) -> Condition:
        """The same with nothing lost: what trackers find as long as they are heard of."""
        return replace(self, silent_sonar=NEVER, silent_array=NEVER)

    def scenario(self, seed: np.random.SeedSequence) -> Scenario:
        """Return a run: ships at random around own ship."""
        generator = np.random.default_rng(seed)
        ships = [_ship(generator, number) for number in range(4)]
        if self.crossing:
            ships = _crossing(ships, generator)
        numbers = generator.integers(1, 2**31, 1 + len(ships))
        for ship, number in zip(ships, numbers[1:], strict=True):
            ship["motion"]["acceleration_seed"] = int(number)
        stations = [_ARRAY | {"misalignment_deg": self.misalignment_deg}]
        mapping: dict[str, Any] = {
            "name": "track-fusion",
            "duration": DURATION,
            "seed": int(numbers[0]),
            "active_sonar": _SONAR | {"false_alarm_probability": self.false_alarm_probability},
            "own_ship": _OWN_SHIP,
            "bearing_sensors": stations + ([_STATION] if self.moored else []),
            "targets": ships,
            "nodes": {
                "tma_tracker": {},
                "track_fusion": {"heading_standard_deviation_deg": 0.0},
            },
        }
        return scenario_from_mapping(mapping, "study track-fusion")


ALIGNED = Condition()

CONDITIONS = {
    "aligned": ALIGNED,
    "array turned by 1 degree": replace(ALIGNED, misalignment_deg=1.0),
    "array turned by 3 degrees": replace(ALIGNED, misalignment_deg=3.0),
    "sonar lost for 5 minutes": replace(ALIGNED, silent_sonar=LOSS),
    "array lost for 5 minutes": replace(ALIGNED, silent_array=LOSS),
    "clutter": replace(ALIGNED, false_alarm_probability=3e-3),
    "clutter, turned by 1 degree": Condition(1.0, 3e-3),
    "crossing ships": replace(ALIGNED, crossing=True),
    "two stations": replace(ALIGNED, moored=True),
}
"""By name, as in the tables."""


def same_sea() -> tuple[tuple[str, ...], ...]:
    """Return the names of conditions, together where ships and what a sonar receives are the same.

    They differ in how the array is turned, or in what is lost.
    """
    seas: dict[Condition, list[str]] = {}
    for name, condition in CONDITIONS.items():
        seas.setdefault(replace(condition.heard, misalignment_deg=0.0), []).append(name)
    return tuple(map(tuple, seas.values()))


_SONAR: dict[str, Any] = {
    "ping_interval": 10.0,
    "maximum_range": 7400.0,
    "range_standard_deviation": 30.0,
    "azimuth_standard_deviation_deg": 1.0,
    "signal_to_noise_ratio_db": 13.0,
    "clutter": "cell",
}
_OWN_SHIP: dict[str, Any] = {
    "position": [0.0, 0.0],
    "course_deg": 0.0,
    "speed": 5.0,
    "turns": [
        {"time": 200.0, "course_deg": 90.0, "rate_deg": 1.0},
        {"time": 400.0, "course_deg": 30.0, "rate_deg": 1.0},
    ],
}
_ARRAY: dict[str, Any] = {
    "sensor_id": "array",
    "angle_kind": "cone",
    "frame_interval": 2.0,
    "angle_standard_deviation_deg": 0.5,
}
_STATION: dict[str, Any] = {
    "sensor_id": "buoy",
    "namespace": "buoy",
    "platform": "fixed",
    "position": [4000.0, 1000.0],
    "angle_kind": "azimuth",
    "frame_interval": 5.0,
    "angle_standard_deviation_deg": 0.5,
}


def _ship(generator: np.random.Generator, number: int) -> dict[str, Any]:
    azimuth = 0.5 * np.pi * number + generator.uniform(0.0, 0.5 * np.pi)
    distance = generator.uniform(NEAREST, FARTHEST)
    course_deg = float(generator.uniform(0.0, 360.0))
    speed = float(generator.uniform(2.0, 6.0))
    place = MIDDLE + distance * np.array([np.cos(azimuth), np.sin(azimuth)])
    begin = place - 0.5 * DURATION * speed * _direction(course_deg)
    return {
        "name": f"ship_{number + 1}",
        "motion": {
            "kind": "kinematic",
            "position": [float(each) for each in begin],
            "course_deg": course_deg,
            "speed": speed,
            "acceleration": ACCELERATION,
        },
    }


def _crossing(ships: list[dict[str, Any]], generator: np.random.Generator) -> list[dict[str, Any]]:
    """Let the first two ships, and the last two, come near each other on their way."""
    for (first, second), time in (((0, 1), 300.0), ((2, 3), 450.0)):
        one, other = (ships[number]["motion"] for number in (first, second))
        place = np.array(one["position"]) + time * one["speed"] * _direction(one["course_deg"])
        turn = float(generator.uniform(30.0, 90.0))
        other["course_deg"] = one["course_deg"] + turn
        back = time * other["speed"] * _direction(other["course_deg"])
        other["position"] = [float(each) for each in place - back]
    return ships


def _direction(course_deg: float) -> np.ndarray:
    course = np.radians(course_deg)
    return np.array([np.sin(course), np.cos(course)])
