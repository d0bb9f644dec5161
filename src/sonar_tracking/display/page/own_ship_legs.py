"""Own ship's legs: when she kept her course, and when she turned."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.motion import compass_from_azimuth
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import nanoseconds

LEAST_RATE = np.radians(0.05)
"""From this rate of turn on she turns, rad/s."""

BASELINE = nanoseconds(4.0)
"""Over which the rate is measured, ns."""

SPACING = nanoseconds(1.0)
"""Of the states that are kept, ns."""

KEPT = 7200
"""States kept, the newest."""

RENEWED = 5
"""Legs are looked at anew after so many states."""

SHORTEST = nanoseconds(10.0)
"""A leg or turn that is shorter belongs to the one before it, ns."""


@dataclass(frozen=True)
class Leg:
    """A straight leg, or a turn.

    Attributes
    ----------
    begin, end : int
        ns.
    turning : bool
        Whether it is a turn.
    course_deg : float
        Compass heading, of a turn the one it ends with, deg.
    """

    begin: int
    end: int
    turning: bool
    course_deg: float


class OwnShipLegs:
    """Finds the legs as own ship's states come.

    A state every second is enough; the last one counts once the next have come.
    """

    def __init__(self) -> None:
        self._states: deque[OwnShipState] = deque(maxlen=KEPT)

    def add(self, state: OwnShipState) -> bool:
        """Take the next state; return whether legs are to be looked at anew."""
        if self._states and state.stamp < self._states[-1].stamp:
            self._states.clear()
        if self._states and state.stamp - self._states[-1].stamp < SPACING:
            return False
        self._states.append(state)
        return len(self._states) % RENEWED == 2

    def legs(self) -> list[Leg]:
        """Return the legs and turns so far, one following on the other."""
        return own_ship_legs(tuple(self._states))


def own_ship_legs(states: Sequence[OwnShipState]) -> list[Leg]:
    """Return the legs and turns of own ship, one following on the other.

    Parameters
    ----------
    states : sequence of OwnShipState
        In order of time.
    """
    if len(states) < 2:
        return []
    stamps = np.array([state.stamp for state in states], np.int64)
    yaw = np.unwrap([state.yaw for state in states])
    half = BASELINE // 2
    before = np.interp(stamps - half, stamps, yaw)
    after = np.interp(stamps + half, stamps, yaw)
    span = np.minimum(stamps + half, stamps[-1]) - np.maximum(stamps - half, stamps[0])
    rate = (after - before) / np.maximum(span, 1) * 1e9
    turning = np.abs(rate) >= LEAST_RATE
    starts = np.flatnonzero(np.diff(turning, prepend=not turning[0]))
    legs: list[Leg] = []
    for first, last in zip(starts, [*starts[1:], len(stamps) - 1], strict=True):
        leg = _leg(stamps, yaw, int(first), int(last), bool(turning[first]))
        short = leg.end - leg.begin < SHORTEST
        if legs and (short or legs[-1].turning == leg.turning):
            previous = legs.pop()
            leg = Leg(previous.begin, leg.end, previous.turning, leg.course_deg)
        legs.append(leg)
    return legs


def _leg(stamps: IntArray, yaw: FloatArray, first: int, last: int, turning: bool) -> Leg:
    part = yaw[first : last + 1]
    heading = part[-1] if turning else np.median(part)
    course = float(compass_from_azimuth(heading))
    return Leg(int(stamps[first]), int(stamps[last]), turning, course)
