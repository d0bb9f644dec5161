"""Where own ship was at the stamps of what others hear."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import replace

from sonar_tracking.motion import KinematicState
from sonar_tracking.own_ship_interpolation import interpolate_own_ship, motion_in_map
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import nanoseconds, seconds

KEPT = 2000
"""Newest states kept."""

FARTHEST = nanoseconds(10.0)
"""So far beyond the known states own ship goes on as it did, ns."""


class OwnShipLog:
    """The newest states of own ship, in order of time."""

    def __init__(self) -> None:
        self._states: list[OwnShipState] = []

    @property
    def is_known(self) -> bool:
        """Whether any state is known."""
        return bool(self._states)

    def add(self, state: OwnShipState) -> None:
        """Take the next state; when the clock has gone back, the later ones are forgotten."""
        while self._states and self._states[-1].stamp >= state.stamp:
            self._states.pop()
        self._states.append(state)
        if len(self._states) > KEPT:
            del self._states[: KEPT // 2]

    def state_at(self, stamp: int) -> OwnShipState | None:
        """Return own ship at a stamp, ns; None = unknown."""
        if not self._states:
            return None
        place = bisect_left(self._states, stamp, key=lambda state: state.stamp)
        if 0 < place < len(self._states):
            before, after = self._states[place - 1], self._states[place]
            return interpolate_own_ship(
                before, after, (stamp - before.stamp) / (after.stamp - before.stamp)
            )
        nearest = self._states[-1] if place else self._states[0]
        if abs(stamp - nearest.stamp) > FARTHEST:
            return None
        return _gone_on(nearest, stamp)

    def motion_at(self, stamp: int) -> KinematicState | None:
        """Return own ship's motion in ``map`` at a stamp, ns; None = unknown."""
        state = self.state_at(stamp)
        return None if state is None else motion_in_map(state)


def _gone_on(state: OwnShipState, stamp: int) -> OwnShipState:
    interval = seconds(stamp - state.stamp)
    velocity = motion_in_map(state).velocity
    return replace(
        state,
        stamp=stamp,
        position=(
            state.position[0] + interval * float(velocity[0]),
            state.position[1] + interval * float(velocity[1]),
        ),
        yaw=state.yaw + interval * state.yaw_rate,
    )
