"""Whether the pose in a message is that of its sensor, or nobody has set it.

A new message has its sensor at the origin of ``map``, not turned, or without any orientation, and
at rest. That may be true, and own ship's motion tells:

- the sensor would be there, and rest, if it were mounted on own ship: true;
- own ship is elsewhere, or moves: unknown, and own ship's pose and the mounting are taken;
- nobody knows own ship's motion: true, and said, since it may be forgotten;
- the frame names another platform: true, and said if own ship is elsewhere.

A pose that was set is used in any case; if own ship's motion says otherwise, that is said.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.motion import KinematicState, lever_arm, swing_velocity, wrapped

Quaternion = tuple[float, float, float, float]

NO_TURNS = ((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 0.0))
"""Quaternions x, y, z, w of a new message: of ROS 2, and of whoever leaves out its defaults."""

SAME_DISTANCE, SAME_ANGLE = 1.0, math.radians(1.0)
"""Two poses that differ by less are the same, m and rad."""

LARGEST_DISTANCE, LARGEST_ANGLE = 500.0, math.radians(45.0)
"""A pose that differs from own ship's by more is reported, m and rad."""

SLOWEST_SHIP = 0.5
"""From this speed on a sensor at rest is not on own ship, m/s."""

CULPRIT = "sensor_pose"

_UNSET = "sensor_pose is that of a new message, at the origin, not turned and at rest"
_REMEDY = "set it, or to NaN where it is not known"


@dataclass(frozen=True)
class PlanePose:
    """Where a sensor is, and how it moves.

    Attributes
    ----------
    position, velocity : tuple of float
        x, y in ``map``, m and m/s.
    yaw : float
        Azimuth of its +x, rad; NaN = not known, or not needed.
    """

    position: tuple[float, float]
    velocity: tuple[float, float]
    yaw: float


@dataclass(frozen=True)
class PoseVerdict:
    """What to make of a pose.

    Attributes
    ----------
    unknown : bool
        It was not set, and is not true.
    notice : Notice or None
        What the user should know; of severity OK where all is well, None where nobody can tell.
    """

    unknown: bool
    notice: Notice | None = None


ALL_WELL = Notice(Severity.OK, CULPRIT, "")


def is_no_turn(orientation: Sequence[float]) -> bool:
    """Return whether a quaternion x, y, z, w is that of a new message."""
    return tuple(orientation) in NO_TURNS


def is_unset(
    position: Sequence[float], orientation: Sequence[float], velocity: Sequence[float]
) -> bool:
    """Return whether pose and velocity are those of a new message.

    Parameters
    ----------
    position : sequence of float, shape (3,)
        x, y, z, m.
    orientation : sequence of float, shape (4,)
        Quaternion x, y, z, w.
    velocity : sequence of float, shape (3,)
        m/s; may be said to be unknown, NaN.
    """
    rests = not any(v for v in velocity if not math.isnan(v))
    return rests and not any(position) and is_no_turn(orientation)


def unit_sized(orientation: Quaternion) -> Quaternion:
    """Return a quaternion of any length as one that can be computed with: the same turn.

    Parameters
    ----------
    orientation : tuple of float, shape (4,)
        Quaternion x, y, z, w. One of about unit length is returned as it is.
    """
    largest = max(map(abs, orientation))
    if not 0.0 < largest < math.inf or 0.25 <= largest <= 2.0:
        return orientation
    x, y, z, w = (value / largest for value in orientation)
    return x, y, z, w


def yaw_of(orientation: Quaternion) -> float:
    """Return the azimuth of +x of a frame, rad; NaN if its orientation is unknown.

    Parameters
    ----------
    orientation : tuple of float, shape (4,)
        Quaternion x, y, z, w.
    """
    if not all(map(math.isfinite, orientation)) or not any(orientation):
        return math.nan
    x, y, z, w = unit_sized(orientation)
    return math.atan2(2.0 * (w * z + x * y), w**2 + x**2 - y**2 - z**2)


def mounted_pose(own_ship: KinematicState, ahead: float, port: float, yaw: float) -> PlanePose:
    """Return the pose of a sensor that is mounted on own ship.

    Parameters
    ----------
    own_ship : KinematicState
        At the stamp.
    ahead, port : float
        Of the sensor, ahead of own ship's reference and to port of it, m.
    yaw : float
        Of its +x, anticlockwise from the bow, rad.
    """
    heading = float(own_ship.azimuth)
    arm = lever_arm(heading, ahead, port)
    position = own_ship.position + arm
    velocity = own_ship.velocity + swing_velocity(float(own_ship.turn_rate), arm)
    return PlanePose(
        (float(position[0]), float(position[1])),
        (float(velocity[0]), float(velocity[1])),
        heading + yaw,
    )


def judge_pose(
    told: PlanePose,
    unset: bool,
    mounted: PlanePose | None,
    odometry: bool,
    another_platform: str = "",
) -> PoseVerdict:
    """Return what to make of the pose in a message.

    Parameters
    ----------
    told : PlanePose
        From the message.
    unset : bool
        See :func:`is_unset`.
    mounted : PlanePose or None
        The pose it has if it is mounted on own ship; None = own ship is not known at the stamp.
    odometry : bool
        Whether own ship's motion is known at some stamps, or will be.
    another_platform : str
        Frame of the sensor, if that names a platform other than own ship.
    """
    if mounted is None:
        if not unset or another_platform:
            return PoseVerdict(unknown=False)
        return PoseVerdict(unknown=odometry, notice=None if odometry else _at_origin())
    distance = math.dist(told.position, mounted.position)
    angle = abs(wrapped(told.yaw - mounted.yaw))
    if not unset:
        return PoseVerdict(False, _contradiction(told, mounted, distance, angle))
    speed = math.hypot(*mounted.velocity)
    if distance < SAME_DISTANCE and not angle > SAME_ANGLE and speed < SLOWEST_SHIP:
        return PoseVerdict(False, ALL_WELL)
    return PoseVerdict(not another_platform, _elsewhere(distance, speed, another_platform))


def _at_origin() -> Notice:
    text = (
        f"{_UNSET}, and there is no own_ship/odometry; the sensor is taken to be there: {_REMEDY}."
    )
    return Notice(Severity.WARN, CULPRIT, text)


def _elsewhere(distance: float, speed: float, another_platform: str) -> Notice:
    where = (
        f"{_UNSET}, but a sensor on own ship is {distance:.0f} m away and moves with "
        f"{speed:.1f} m/s"
    )
    if another_platform:
        used = f"since {another_platform} is not own ship's, it is taken to be at the origin"
    else:
        used = "the pose by own_ship/odometry and the mounting is used instead"
    return Notice(Severity.WARN, CULPRIT, f"{where}; {used}: {_REMEDY}.")


def _contradiction(told: PlanePose, mounted: PlanePose, distance: float, angle: float) -> Notice:
    speed = math.hypot(*mounted.velocity)
    if distance > LARGEST_DISTANCE:
        what = f"sensor_pose is {distance:.0f} m from where"
    elif angle > LARGEST_ANGLE:
        what = f"sensor_pose is turned by {math.degrees(angle):.0f} degrees from how"
    elif not any(told.velocity) and speed > SLOWEST_SHIP:
        text = (
            f"sensor_velocity is zero, but own ship moves with {speed:.1f} m/s; zero is used: set "
            "it, or to NaN where it is not known."
        )
        return Notice(Severity.WARN, CULPRIT, text)
    else:
        return ALL_WELL
    text = (
        f"{what} own_ship/odometry and the mounting have the sensor; that of the message is used. "
        "Check frame and units of both, and the parameters mounting_x, mounting_y and "
        "mounting_yaw_deg."
    )
    return Notice(Severity.WARN, CULPRIT, text)
