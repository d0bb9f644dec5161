"""Own ship's pose in three dimensions, from odometry."""

from __future__ import annotations

import math
from typing import Any

from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.scene.rigid_pose import RigidPose, turned_about_z, unit_quaternion
from sonar_tracking.scene.scene_frames import OwnShipPose
from sonar_tracking.sensor_pose import is_no_turn


def own_ship_pose_from_message(message: Any, state: OwnShipState) -> OwnShipPose:
    """Return own ship's pose, with the depth, roll and pitch that its motion leaves out.

    Parameters
    ----------
    message : Odometry
        As received.
    state : OwnShipState
        What the trackers read from it; its yaw is taken where the orientation was never set.
    """
    position, turn = message.pose.pose.position, message.pose.pose.orientation
    told = (turn.x, turn.y, turn.z, turn.w)
    orientation = None if is_no_turn(told) else unit_quaternion(told)
    height = position.z if math.isfinite(position.z) else 0.0
    pose = RigidPose((*state.position, height), orientation or turned_about_z(state.yaw))
    return OwnShipPose(state, pose)
