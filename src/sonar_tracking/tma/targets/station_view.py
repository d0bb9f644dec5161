"""Where a station is, which way it faces, and the azimuths its angles stand for.

A line array whose axis has azimuth psi turns an arrival angle theta from broadside into the
azimuths psi + (pi/2 - theta) on its left and psi - (pi/2 - theta) on its right. Any other array
knows which.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import InputError, Notice, shown
from sonar_tracking.motion import KinematicState, lever_arm, swing_velocity, wrapped
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.own_ship import OWN_SHIP_FRAMES
from sonar_tracking.records.positions import MAP_FRAME
from sonar_tracking.sensor_pose import PlanePose, is_unset, judge_pose, mounted_pose, yaw_of
from sonar_tracking.tma.targets.line_attribution import VAGUEST, TrackAngle
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

FARTHEST = 1e8
"""Largest coordinate of a station in ``map``, m."""


@dataclass(frozen=True)
class StationView:
    """A station at one instant.

    Attributes
    ----------
    sensor_id, frame_id : str
        Who it is, and the frame its angles are in.
    position, velocity : tuple of float
        In ``map``, m and m/s.
    z : float
        Height in ``map``, m; 0 if its data do not tell it.
    axis : float
        Azimuth of the x axis of its frame, rad.
    turn_rate : float
        Of own ship if that carries it, else 0, rad/s.
    """

    sensor_id: str
    frame_id: str
    position: tuple[float, float]
    velocity: tuple[float, float]
    axis: float
    turn_rate: float
    z: float = 0.0

    def azimuths(self, angle: float, kind: AngleKind, ambiguous: bool) -> tuple[float, ...]:
        """Return the azimuths in ``map`` of a measured angle: one, or left and right.

        Parameters
        ----------
        angle : float
            rad.
        kind : AngleKind
            What the angle is.
        ambiguous : bool
            Whether a cone has two sides.
        """
        if kind is AngleKind.AZIMUTH:
            axis = 0.0 if self.frame_id == MAP_FRAME else self.axis
            return (wrapped(axis + angle),)
        from_axis = 0.5 * np.pi - angle
        left = wrapped(self.axis + from_axis)
        return (left, wrapped(self.axis - from_axis)) if ambiguous else (left,)

    def from_broadside(self, angle: float, kind: AngleKind) -> float:
        """Return the angle from broadside of the cone on which a measured angle lies, rad."""
        if kind is AngleKind.CONE:
            return math.asin(math.sin(angle))
        (azimuth,) = self.azimuths(angle, kind, ambiguous=False)
        return 0.5 * np.pi - abs(wrapped(azimuth - self.axis))


@dataclass
class StationRecord:
    """What is remembered of a station between its frames.

    Attributes
    ----------
    next_stamp : int
        Its watermark, ns.
    angles : dict of int to TrackAngle
        Of its bearing tracks.
    """

    next_stamp: int
    angles: dict[int, TrackAngle]


def needs_own_ship(sensor: Sensor, configuration: TmaTrackerConfiguration) -> bool:
    """Return whether own ship's motion is needed to know where a sensor is, and how it turns."""
    told = (*sensor.position[:2], *sensor.velocity[:2], yaw_of(sensor.orientation))
    turning = configuration.array_lag > 0.0 and sensor.frame_id.startswith(OWN_SHIP_FRAMES)
    return turning or not all(map(math.isfinite, told))


def may_be_unset(sensor: Sensor) -> bool:
    """Return whether own ship's motion decides if the pose of a sensor was ever set."""
    return _is_unset(sensor) and not _another_platform(sensor)


def with_pose_judged(
    sensor: Sensor,
    own_ship: KinematicState | None,
    configuration: TmaTrackerConfiguration,
    odometry: bool,
) -> tuple[Sensor, Notice | None]:
    """Return a sensor whose pose is unknown if nobody has set it, and what to say of its pose.

    The direction of an array whose pose was set is not compared: a towed one follows a turn late.

    Parameters
    ----------
    sensor : Sensor
        From the data.
    own_ship : KinematicState or None
        At the stamp of the data; None = unknown.
    configuration : TmaTrackerConfiguration
        Mounting of an array whose pose is unknown.
    odometry : bool
        Whether own ship's motion is known at some stamps, or will be.
    """
    unset = _is_unset(sensor)
    located = all(map(math.isfinite, (*sensor.position[:2], *sensor.velocity[:2])))
    if not unset and not (located and sensor.frame_id.startswith(OWN_SHIP_FRAMES)):
        return sensor, None
    yaw = yaw_of(sensor.orientation) if unset else math.nan
    told = PlanePose(sensor.position[:2], sensor.velocity[:2], yaw)
    mounted = None
    if own_ship is not None:
        place = configuration.mounting_x, configuration.mounting_y
        mounted = mounted_pose(own_ship, *place, configuration.mounting_yaw)
    verdict = judge_pose(told, unset, mounted, odometry, _another_platform(sensor))
    if not verdict.unknown:
        return sensor, verdict.notice
    return Sensor(sensor.sensor_id, sensor.frame_id), verdict.notice


def _is_unset(sensor: Sensor) -> bool:
    return is_unset(sensor.position, sensor.orientation, sensor.velocity)


def _another_platform(sensor: Sensor) -> str:
    """Return the frame of a sensor if it is below that of a platform other than own ship."""
    platform, below, _ = sensor.frame_id.partition("/")
    return sensor.frame_id if below and f"{platform}/" != OWN_SHIP_FRAMES else ""


def station_view(
    sensor: Sensor, own_ship: KinematicState | None, configuration: TmaTrackerConfiguration
) -> StationView:
    """Return where a station is: as its data tell, else from own ship and the mounting.

    Parameters
    ----------
    sensor : Sensor
        From the data; NaN = unknown.
    own_ship : KinematicState or None
        At the stamp of the data.
    configuration : TmaTrackerConfiguration
        Mounting of an array whose pose is unknown.

    Raises
    ------
    InputError
        If neither tells.
    """
    position, velocity = sensor.position[:2], sensor.velocity[:2]
    axis = yaw_of(sensor.orientation)
    known = all(map(math.isfinite, (*position, *velocity, axis)))
    if own_ship is None:
        if not known:
            raise InputError(
                f"{shown(sensor.sensor_id)} does not tell its pose and velocity, and own ship's "
                "are not known at this stamp; send own_ship/odometry, or the pose with the data."
            )
        turn_rate = 0.0
    else:
        aboard = not known or sensor.frame_id.startswith(OWN_SHIP_FRAMES)
        turn_rate = float(own_ship.turn_rate) if aboard else 0.0
        heading = float(own_ship.azimuth)
        arm = lever_arm(heading, configuration.mounting_x, configuration.mounting_y)
        if not all(map(math.isfinite, position)):
            position = tuple(own_ship.position + arm)
        if not all(map(math.isfinite, velocity)):
            velocity = tuple(own_ship.velocity + swing_velocity(turn_rate, arm))
        if not math.isfinite(axis):
            axis = heading + configuration.mounting_yaw
    if max(map(abs, position)) > FARTHEST or math.hypot(*velocity) >= configuration.sound_speed:
        raise InputError(
            f"{shown(sensor.sensor_id)} is said to be at {position[0]:g}, {position[1]:g} m and to "
            f"move with {math.hypot(*velocity):g} m/s; check its pose, and own ship's odometry."
        )
    return StationView(
        sensor_id=sensor.sensor_id,
        frame_id=sensor.frame_id,
        position=(float(position[0]), float(position[1])),
        velocity=(float(velocity[0]), float(velocity[1])),
        axis=axis,
        turn_rate=turn_rate,
        z=float(sensor.position[2]) if math.isfinite(sensor.position[2]) else 0.0,
    )


def track_angles(bearings: BearingTracks, view: StationView) -> dict[int, TrackAngle]:
    """Return where the bearing tracks of a station are, from broadside."""
    angles = {}
    for row in np.flatnonzero(bearings.status != TrackStatus.TERMINATED):
        angle = float(bearings.arrival_angle[row])
        variance = float(bearings.covariance[row, 0, 0])
        if abs(angle) <= 2.0 * np.pi and 0.0 <= variance < VAGUEST:
            cone = view.from_broadside(angle, bearings.angle_kind)
            angles[int(bearings.id[row])] = TrackAngle(cone, variance)
    return angles
