"""Where the sensor of a ping is and how it is turned: from the ping, or from own ship's motion.

A sensor that does not tell its pose is mounted on own ship at the place the parameters say. Whether
a pose that looks like that of a new message is one, own ship's motion tells, too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import InputError, Notice
from sonar_tracking.motion import KinematicState, wrap_angle
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import MAP_FRAME
from sonar_tracking.sensor_pose import PlanePose, judge_pose, mounted_pose

UNKNOWN = (math.nan, math.nan)


@dataclass(frozen=True)
class MountingConfiguration:
    """Where a sensor is on own ship; used where its messages do not carry its pose."""

    mounting_x: float = parameter(
        0.0, "sensor ahead of own ship's reference, where contacts do not tell its pose", unit="m"
    )
    mounting_y: float = parameter(0.0, "sensor to port of it", unit="m")
    mounting_yaw_deg: float = parameter(
        0.0, "direction of +x of the sensor, anticlockwise from the bow", unit="deg"
    )


def needs_own_ship(contacts: Contacts) -> bool:
    """Return whether the pose of the sensor has to come from own ship's motion."""
    known = (*contacts.sensor_position, *contacts.sensor_velocity)
    turned = contacts.frame_id != MAP_FRAME and math.isnan(contacts.sensor_yaw)
    return turned or any(map(math.isnan, known))


def with_pose_judged(
    contacts: Contacts,
    own_ship: KinematicState | None,
    mounting: MountingConfiguration,
    odometry: bool,
) -> tuple[Contacts, Notice | None]:
    """Return a ping whose pose is unknown if nobody has set it, and what to say of its pose.

    Parameters
    ----------
    contacts : Contacts
        As received.
    own_ship : KinematicState or None
        At the stamp of the ping; None = unknown.
    mounting : MountingConfiguration
        Where the sensor is on own ship.
    odometry : bool
        Whether own ship's motion is known at some stamps, or will be.
    """
    if needs_own_ship(contacts) and not contacts.unset_pose:
        return contacts, None
    turned = contacts.frame_id != MAP_FRAME
    told = PlanePose(
        contacts.sensor_position,
        contacts.sensor_velocity,
        contacts.sensor_yaw if turned else math.nan,
    )
    mounted = None if own_ship is None else _mounted(own_ship, mounting)
    verdict = judge_pose(told, contacts.unset_pose, mounted, odometry)
    if not verdict.unknown:
        return contacts, verdict.notice
    unknown = replace(
        contacts, sensor_position=UNKNOWN, sensor_velocity=UNKNOWN, sensor_yaw=math.nan
    )
    return unknown, verdict.notice


def located(
    contacts: Contacts, own_ship: KinematicState | None, mounting: MountingConfiguration
) -> Contacts:
    """Return a ping with the pose of its sensor known, and its azimuths in ``map``.

    Parameters
    ----------
    contacts : Contacts
        NaN = unknown.
    own_ship : KinematicState or None
        At the stamp of the ping; None = unknown.
    mounting : MountingConfiguration
        Where the sensor is on own ship.

    Raises
    ------
    InputError
        If own ship is needed and unknown.
    """
    if needs_own_ship(contacts):
        contacts = _on_own_ship(contacts, own_ship, mounting)
    if contacts.frame_id == MAP_FRAME:
        return contacts
    return replace(
        contacts,
        azimuth=wrap_angle(contacts.azimuth + contacts.sensor_yaw),
        minimum_azimuth=float(wrap_angle(contacts.minimum_azimuth + contacts.sensor_yaw)),
        frame_id=MAP_FRAME,
    )


def _on_own_ship(
    contacts: Contacts, own_ship: KinematicState | None, mounting: MountingConfiguration
) -> Contacts:
    if own_ship is None:
        raise InputError(
            "The ping does not tell where its sensor is, and there is no odometry at its stamp; "
            "publish own_ship/odometry before and after it, or set sensor_pose and "
            "sensor_velocity."
        )
    pose = _mounted(own_ship, mounting)
    return replace(
        contacts,
        sensor_position=_filled(contacts.sensor_position, pose.position),
        sensor_velocity=_filled(contacts.sensor_velocity, pose.velocity),
        sensor_yaw=pose.yaw if math.isnan(contacts.sensor_yaw) else contacts.sensor_yaw,
    )


def _mounted(own_ship: KinematicState, mounting: MountingConfiguration) -> PlanePose:
    yaw = math.radians(mounting.mounting_yaw_deg)
    return mounted_pose(own_ship, mounting.mounting_x, mounting.mounting_y, yaw)


def _filled(told: tuple[float, float], computed: tuple[float, float]) -> tuple[float, float]:
    return computed if any(map(math.isnan, told)) else told
