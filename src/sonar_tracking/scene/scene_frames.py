"""The tree of frames: ``map``, own ship in it, and every sensor on own ship or in ``map``.

What belongs where is not told by anybody, so it is found out, message by message:

- a sensor whose messages do not carry its pose is mounted on own ship, where the parameters say;
- one whose messages carry a pose is mounted, too, if it is near own ship, moves with it, and keeps
  its place aboard: its pose in own ship's frame is fixed;
- any other (a moored or distant one, a towed array that follows a turn late) has its pose in
  ``map``, that of each message.

A pose needs own ship's at the same instant: messages wait for the odometry that comes after them.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import deque
from dataclasses import dataclass

from sonar_tracking.motion import KinematicState
from sonar_tracking.own_ship_interpolation import interpolate_own_ship, motion_in_map
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.own_ship import BASE_FRAME, OWN_SHIP_FRAMES, OwnShipState
from sonar_tracking.records.positions import MAP_FRAME
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.scene.rigid_pose import RigidPose, unit_quaternion
from sonar_tracking.scene.waiting_for_own_ship import WaitingForOwnShip
from sonar_tracking.sensor_pose import (
    LARGEST_DISTANCE,
    SAME_ANGLE,
    SAME_DISTANCE,
    SLOWEST_SHIP,
    PlanePose,
    is_unset,
    judge_pose,
    mounted_pose,
    yaw_of,
)

MEMORY = nanoseconds(600.0)
"""Own ship is remembered for so long: it may be told many pings before the echoes of one, ns."""

NEW_BEGINNING = nanoseconds(10.0)
"""Stamps that go back by more begin the data again; those that go back by less are late, ns."""


@dataclass(frozen=True)
class FrameTransform:
    """Pose of one frame in another.

    Attributes
    ----------
    stamp : int
        When it is true, ns.
    parent, child : str
        The frames.
    pose : RigidPose
        Of the child in the parent.
    """

    stamp: int
    parent: str
    child: str
    pose: RigidPose


@dataclass(frozen=True)
class OwnShipPose:
    """Own ship at one instant.

    Attributes
    ----------
    state : OwnShipState
        Its horizontal motion, as the trackers know it.
    pose : RigidPose
        In the parent frame.
    """

    state: OwnShipState
    pose: RigidPose


@dataclass(frozen=True)
class HeardSensor:
    """What a message tells of its sensor.

    Attributes
    ----------
    stamp : int
        Of the message, ns.
    sensor : Sensor
        NaN = unknown.
    mounting : RigidPose
        Where it is on own ship, if it does not tell its pose.
    """

    stamp: int
    sensor: Sensor
    mounting: RigidPose


class SceneFrames:
    """Finds the transforms of the scene.

    Parameters
    ----------
    prefix : str
        Before the names of all frames but ``map``, e.g. ``"ship_a/"``: two graphs in one world
        must not both have an own ship of the same name.

    Attributes
    ----------
    fixed : dict of str to FrameTransform
        Of the sensors that are mounted on own ship, by their frame.
    """

    def __init__(self, prefix: str = "") -> None:
        self._prefix = prefix
        self._base = prefix + BASE_FRAME
        self._own_ship: deque[OwnShipPose] = deque()
        self._waiting: WaitingForOwnShip[HeardSensor] = WaitingForOwnShip()
        self._loose: set[str] = set()
        self._owners: dict[str, str] = {}
        self._told: dict[str, int] = {}
        self.fixed: dict[str, FrameTransform] = {}

    def own_ship_told(
        self, own_ship: OwnShipPose, parent: str = "", child: str = ""
    ) -> list[FrameTransform]:
        """Take own ship's pose; return what moves, with the sensors that have waited for it.

        Parameters
        ----------
        own_ship : OwnShipPose
            From odometry.
        parent, child : str
            Frames that odometry names; empty = ``map`` and ``own_ship/base_link``.
        """
        stamp = own_ship.state.stamp
        last = self._own_ship[-1].state.stamp if self._own_ship else stamp - 1
        if stamp < last - NEW_BEGINNING:
            self._own_ship.clear()
            self._waiting.clear()
        elif stamp <= last:
            return []
        while len(self._own_ship) > 1 and self._own_ship[1].state.stamp <= stamp - MEMORY:
            self._own_ship.popleft()
        self._own_ship.append(own_ship)
        self._base = self._prefix + (child.lstrip("/") or BASE_FRAME)
        moving = [
            self._moving(stamp, parent.lstrip("/") or MAP_FRAME, self._base, own_ship.pose),
            *(self._placed(heard) for heard in self._waiting.released(stamp)),
        ]
        return [transform for transform in moving if transform is not None]

    def sensor_told(self, heard: HeardSensor, odometry: bool) -> list[FrameTransform]:
        """Take what a message tells of its sensor; return what moves.

        Parameters
        ----------
        heard : HeardSensor
            From the message.
        odometry : bool
            Whether own ship's motion is known at some stamps, or will be.
        """
        if odometry and not self.knows_own_ship(heard.stamp):
            self._waiting.keep(heard.stamp, heard)
            return []
        moving = self._placed(heard)
        return [] if moving is None else [moving]

    def knows_own_ship(self, stamp: int) -> bool:
        """Return whether odometry has come as far as a stamp, ns."""
        return bool(self._own_ship) and stamp <= self._own_ship[-1].state.stamp

    def own_ship_at(self, stamp: int) -> OwnShipPose | None:
        """Return own ship at an instant within what is remembered; the stamp is in ns."""
        if not self._own_ship or stamp < self._own_ship[0].state.stamp:
            return None
        index = bisect_left(self._own_ship, stamp, key=lambda each: each.state.stamp)
        if index == len(self._own_ship):
            return None
        after = self._own_ship[index]
        if after.state.stamp == stamp:
            return after
        before = self._own_ship[index - 1]
        interval = after.state.stamp - before.state.stamp
        fraction = (stamp - before.state.stamp) / interval
        return OwnShipPose(
            interpolate_own_ship(before.state, after.state, fraction),
            before.pose.towards(after.pose, fraction),
        )

    def _placed(self, heard: HeardSensor) -> FrameTransform | None:
        """Return the transform of a sensor that is not mounted; keep that of one that is."""
        own_ship = self.own_ship_at(heard.stamp)
        mounted = None if own_ship is None else heard.mounting.placed_in(own_ship.pose)
        told = _told_pose(heard.sensor, mounted)
        if own_ship is not None and (told is None or _nobody_set(heard, own_ship)):
            self._fix(heard, heard.mounting)
            return None
        if told is None:
            return None
        if own_ship is not None:
            aboard = told.seen_from(own_ship.pose)
            if self._keeps_its_place(heard.sensor, aboard, own_ship):
                self._fix(heard, aboard)
                return None
            # One that has been aboard and has left its place is not believed again.
            self._loose.add(heard.sensor.sensor_id)
            self.fixed.pop(self._frame(heard.sensor, aboard=True), None)
        return self._moving(heard.stamp, MAP_FRAME, self._frame(heard.sensor, aboard=False), told)

    def _keeps_its_place(self, sensor: Sensor, aboard: RigidPose, own_ship: OwnShipPose) -> bool:
        if sensor.sensor_id in self._loose:
            return False
        before = self.fixed.get(self._frame(sensor, aboard=True))
        if before is not None:
            moved = math.dist(before.pose.position, aboard.position)
            return moved < SAME_DISTANCE and before.pose.angle_to(aboard) < SAME_ANGLE
        if math.hypot(*aboard.position) > LARGEST_DISTANCE or _another_platform(sensor):
            return False
        if not all(map(math.isfinite, sensor.velocity[:2])):
            return True
        ahead, port, _ = aboard.position
        with_it = mounted_pose(motion_in_map(own_ship.state), ahead, port, 0.0).velocity
        return math.dist(sensor.velocity[:2], with_it) < SLOWEST_SHIP

    def _fix(self, heard: HeardSensor, pose: RigidPose) -> None:
        child = self._frame(heard.sensor, aboard=True)
        if child not in self.fixed or self.fixed[child].parent != self._base:
            self.fixed[child] = FrameTransform(heard.stamp, self._base, child, pose)

    def _moving(
        self, stamp: int, parent: str, child: str, pose: RigidPose
    ) -> FrameTransform | None:
        """Return a transform, or nothing for a frame that is known at this stamp or a later one."""
        last = self._told.get(child)
        if last is not None and last - NEW_BEGINNING <= stamp <= last:
            return None
        self._told[child] = stamp
        return FrameTransform(stamp, parent, child, pose)

    def _frame(self, sensor: Sensor, aboard: bool) -> str:
        """Return the frame of a sensor: its own one, if its messages name it."""
        frame = self._prefix + sensor.frame_id.lstrip("/")
        own = sensor.frame_id not in ("", MAP_FRAME) and frame != self._base
        if own and self._owners.setdefault(frame, sensor.sensor_id) == sensor.sensor_id:
            return frame
        name = sensor.sensor_id or "sensor"
        return self._prefix + (OWN_SHIP_FRAMES + name if aboard else name)


def _told_pose(sensor: Sensor, mounted: RigidPose | None) -> RigidPose | None:
    """Return the pose in ``map`` a sensor tells; what it leaves open is taken from its mounting."""
    located = all(map(math.isfinite, sensor.position[:2]))
    orientation = unit_quaternion(sensor.orientation)
    if not located and (orientation is None or mounted is None):
        return None
    usual = mounted or RigidPose()
    x, y, z = sensor.position if located else usual.position
    return RigidPose((x, y, z if math.isfinite(z) else 0.0), orientation or usual.orientation)


def _nobody_set(heard: HeardSensor, own_ship: OwnShipPose) -> bool:
    """Return whether a pose is that of a new message and, by own ship's, not true."""
    sensor = heard.sensor
    if not is_unset(sensor.position, sensor.orientation, sensor.velocity):
        return False
    ahead, port, _ = heard.mounting.position
    yaw = yaw_of(heard.mounting.orientation)
    mounted: KinematicState = motion_in_map(own_ship.state)
    return judge_pose(
        PlanePose(sensor.position[:2], sensor.velocity[:2], yaw_of(sensor.orientation)),
        unset=True,
        mounted=mounted_pose(mounted, ahead, port, yaw),
        odometry=True,
        another_platform=_another_platform(sensor),
    ).unknown


def _another_platform(sensor: Sensor) -> str:
    """Return the frame of a sensor if it is below that of a platform other than own ship."""
    frame = sensor.frame_id.lstrip("/")
    return frame if "/" in frame and not frame.startswith(OWN_SHIP_FRAMES) else ""
