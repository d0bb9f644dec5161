"""Frames as tf2 takes them."""

from __future__ import annotations

from sonar_tracking.graph.message_writing.transform_writing import transforms_to_message
from sonar_tracking.scene.rigid_pose import RigidPose
from sonar_tracking.scene.scene_frames import FrameTransform


def test_a_transform_is_the_pose_of_the_child_in_its_parent() -> None:
    pose = RigidPose((1.0, 2.0, 3.0), (0.0, 0.6, 0.0, 0.8))
    frames = [FrameTransform(5_000_000_007, "map", "own_ship/base_link", pose)]
    (message,) = transforms_to_message(frames).transforms
    assert message.header.frame_id == "map"
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (5, 7)
    assert message.child_frame_id == "own_ship/base_link"
    moved, turned = message.transform.translation, message.transform.rotation
    assert (moved.x, moved.y, moved.z) == (1.0, 2.0, 3.0)
    assert (turned.x, turned.y, turned.z, turned.w) == (0.0, 0.6, 0.0, 0.8)
