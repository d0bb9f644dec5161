"""Own ship's motion from odometry that tells positions only.

Navigation that knows positions often leaves the twist at zero and the orientation as it is in a new
message. A ship whose positions move is not at rest: the rate of its positions is its velocity, and
its course its heading if the orientation was never set.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.message_reading.array_reading import own_ship_from_message
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import nanoseconds, seconds
from sonar_tracking.sensor_pose import is_no_turn

ODOMETRY_TYPE = "nav_msgs/msg/Odometry"

BASELINE = nanoseconds(10.0)
"""Positions this far apart in time tell the velocity, ns: errors of a metre are 0.1 m/s then."""

SLOWEST = 0.5
"""Positions that move more slowly do not contradict a twist of zero, m/s."""

CULPRIT = "twist"


class OwnShipReader:
    """Reads odometry, message by message.

    Parameters
    ----------
    tell : callable
        Takes a notice on the twist with each message; of severity OK where all is well.
    """

    def __init__(self, tell: Callable[[Notice], None] = lambda notice: None) -> None:
        self._tell = tell
        self._states: deque[OwnShipState] = deque()
        self._course: float | None = None

    def __call__(self, message: Any) -> OwnShipState:
        """Return the horizontal motion a message carries, in order of time.

        Raises
        ------
        InputError
            When it holds no pose.
        """
        told = own_ship_from_message(message)
        if self._states and told.stamp <= self._states[-1].stamp:
            self._states.clear()
            self._course = None
        while len(self._states) > 1 and self._states[1].stamp <= told.stamp - BASELINE:
            self._states.popleft()
        turn = message.pose.pose.orientation
        state = self._completed(told, is_no_turn((turn.x, turn.y, turn.z, turn.w)))
        self._states.append(state)
        return state

    def _completed(self, told: OwnShipState, no_turn: bool) -> OwnShipState:
        """Return the state with what the positions tell and the twist does not."""
        if any(told.velocity) or told.yaw_rate:
            self._tell(Notice(Severity.OK, CULPRIT, ""))
            return told
        if not self._states:
            return told
        oldest, last = self._states[0], self._states[-1]
        interval = seconds(told.stamp - oldest.stamp)
        east, north = (
            (now - before) / interval
            for now, before in zip(told.position, oldest.position, strict=True)
        )
        speed = math.hypot(east, north)
        moves = speed > SLOWEST
        if moves and no_turn:
            self._course = math.atan2(north, east)
        yaw = self._course if no_turn and self._course is not None else told.yaw
        if not moves:
            return replace(told, yaw=yaw)
        self._tell(_notice(speed, no_turn))
        cosine, sine = math.cos(yaw), math.sin(yaw)
        arc = math.remainder(yaw - last.yaw, 2.0 * math.pi)
        return replace(
            told,
            yaw=yaw,
            velocity=(cosine * east + sine * north, cosine * north - sine * east),
            yaw_rate=arc / seconds(told.stamp - last.stamp) if len(self._states) > 1 else 0.0,
        )


def _notice(speed: float, no_turn: bool) -> Notice:
    heading = " and their course for the heading, which is that of a new message" * no_turn
    text = (
        f"the twist is zero, but the positions move with {speed:.1f} m/s; the rate of the "
        f"positions is taken{heading}. Fill in twist, in own_ship/base_link, and the orientation."
    )
    return Notice(Severity.WARN, CULPRIT, text)
