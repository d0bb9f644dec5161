"""Own ship between two odometry messages, and its motion in ``map``."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence

import numpy as np

from sonar_tracking.motion import KinematicState
from sonar_tracking.records.own_ship import OwnShipState


def interpolate_own_ship(
    before: OwnShipState, after: OwnShipState, fraction: float
) -> OwnShipState:
    """Return the state between two, linear in everything, the yaw by the shortest arc.

    Parameters
    ----------
    before, after : OwnShipState
        Neighbouring states.
    fraction : float
        0 = before, 1 = after.
    """

    def between(first: float, second: float) -> float:
        return first + fraction * (second - first)

    arc = math.remainder(after.yaw - before.yaw, 2.0 * math.pi)
    yaw = math.remainder(before.yaw + fraction * arc, 2.0 * math.pi)
    return OwnShipState(
        stamp=before.stamp + round(fraction * (after.stamp - before.stamp)),
        position=(
            between(before.position[0], after.position[0]),
            between(before.position[1], after.position[1]),
        ),
        yaw=yaw,
        velocity=(
            between(before.velocity[0], after.velocity[0]),
            between(before.velocity[1], after.velocity[1]),
        ),
        yaw_rate=between(before.yaw_rate, after.yaw_rate),
    )


def motion_at(
    states: Sequence[OwnShipState], stamps: Sequence[int], stamp: int
) -> KinematicState | None:
    """Return own ship at an instant between two of its states; None outside of them.

    Parameters
    ----------
    states : sequence of OwnShipState
        In order of time.
    stamps : sequence of int
        Theirs, ns.
    stamp : int
        ns.
    """
    place = bisect_right(stamps, stamp) - 1
    if place < 0 or (place + 1 == len(stamps) and stamps[place] != stamp):
        return None
    before = states[place]
    if before.stamp == stamp:
        return motion_in_map(before)
    after = states[place + 1]
    fraction = (stamp - before.stamp) / (after.stamp - before.stamp)
    return motion_in_map(interpolate_own_ship(before, after, fraction))


def motion_in_map(state: OwnShipState) -> KinematicState:
    """Return own ship with its velocity in ``map``."""
    cosine, sine = math.cos(state.yaw), math.sin(state.yaw)
    forward, port = state.velocity
    return KinematicState(
        position=np.array(state.position),
        velocity=np.array([cosine * forward - sine * port, sine * forward + cosine * port]),
        azimuth=np.array(state.yaw),
        turn_rate=np.array(state.yaw_rate),
    )
