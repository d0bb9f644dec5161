"""Platforms of a scenario: own ship with its array, and what moves in the frame ``map``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from sonar_tracking.configuration import SECTION, parameter
from sonar_tracking.motion import Trajectory, Turn, azimuth_from_compass


@dataclass(frozen=True)
class TurnConfiguration:
    """One turn of a platform: at constant rate to a new course, the shorter way round."""

    time: float = parameter(0.0, "when the turn begins", unit="s", minimum=0.0)
    course_deg: float = parameter(0.0, "new compass course", unit="deg")
    rate_deg: float = parameter(1.0, "turn rate", unit="deg/s", minimum=1e-6, maximum=360.0)


def make_trajectory(
    position: Sequence[float],
    course_deg: float,
    speed: float,
    turns: Sequence[TurnConfiguration],
) -> Trajectory:
    """Return the motion described by compass courses in degrees."""
    return _trajectory(tuple(position), course_deg, speed, tuple(turns))


@lru_cache(maxsize=32)
def _trajectory(
    position: tuple[float, ...],
    course_deg: float,
    speed: float,
    turns: tuple[TurnConfiguration, ...],
) -> Trajectory:
    return Trajectory(
        position,
        float(azimuth_from_compass(course_deg)),
        speed,
        [
            Turn(turn.time, float(azimuth_from_compass(turn.course_deg)), np.radians(turn.rate_deg))
            for turn in turns
        ],
    )


@dataclass(frozen=True)
class OwnShipConfiguration:
    """Motion of own ship; by default it rests at the origin of ``map`` and heads north."""

    position: tuple[float, ...] = parameter((0.0, 0.0), "x, y in map at scenario time 0", unit="m")
    course_deg: float = parameter(0.0, "compass course until the first turn", unit="deg")
    speed: float = parameter(0.0, "constant speed", unit="m/s", minimum=0.0, maximum=100.0)
    turns: tuple[TurnConfiguration, ...] = field(default=(), metadata=SECTION)

    def trajectory(self) -> Trajectory:
        """Return the motion of own ship."""
        return self._trajectory

    @cached_property
    def _trajectory(self) -> Trajectory:
        return make_trajectory(self.position, self.course_deg, self.speed, self.turns)


OWN_SHIP, FIXED, CONSORT = "own_ship", "fixed", "consort"
"""What carries a sensor: own ship, the ground, or the second ship of a scenario."""


@dataclass(frozen=True)
class Platforms:
    """What may carry sensors.

    Attributes
    ----------
    own_ship : OwnShipConfiguration
        Own ship.
    consort : OwnShipConfiguration or None
        Another ship with sensors of the same side; None = there is none.
    """

    own_ship: OwnShipConfiguration
    consort: OwnShipConfiguration | None = None

    def trajectory(
        self, platform: str, position: Sequence[float], course_deg: float = 0.0
    ) -> Trajectory:
        """Return the motion of a platform; position (x, y, m) and heading are of a fixed one.

        Parameters
        ----------
        platform : str
            Which.
        position : sequence of float
            x, y in ``map``, m.
        course_deg : float
            Compass heading, degrees.
        """
        if platform == OWN_SHIP:
            return self.own_ship.trajectory()
        if platform == CONSORT and self.consort is not None:
            return self.consort.trajectory()
        return make_trajectory(position, course_deg, 0.0, ())


@dataclass(frozen=True)
class Receiver:
    """What the propagation geometry needs to know of the receiving array.

    The array's origin is own ship's reference point.

    Attributes
    ----------
    trajectory : Trajectory
        Of own ship.
    mounting_yaw : float
        Direction of the array axis (first to last element) in ``own_ship/base_link``, rad
        anticlockwise from the bow.
    sound_speed : float
        m/s.
    ambiguous : bool
        True for a line array: it measures a cone and maps both of its sides to one angle in
        [-pi/2, pi/2]. Otherwise arrival angles go all the way round.
    """

    trajectory: Trajectory
    mounting_yaw: float
    sound_speed: float
    ambiguous: bool
