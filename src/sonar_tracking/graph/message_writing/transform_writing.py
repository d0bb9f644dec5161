"""Frames to the messages of ``/tf`` and ``/tf_static``."""

from __future__ import annotations

from collections.abc import Iterable

from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from sonar_tracking.graph.message_writing.field_writing import (
    set_quaternion,
    set_vector,
    time_from_stamp,
)
from sonar_tracking.scene.scene_frames import FrameTransform


def transforms_to_message(transforms: Iterable[FrameTransform]) -> TFMessage:
    """Return the poses of frames in their parents as one message."""
    return TFMessage(transforms=[_transform(each) for each in transforms])


def _transform(record: FrameTransform) -> TransformStamped:
    message = TransformStamped(child_frame_id=record.child)
    message.header.frame_id = record.parent
    message.header.stamp = time_from_stamp(record.stamp)
    set_vector(message.transform.translation, record.pose.position)
    set_quaternion(message.transform.rotation, record.pose.orientation)
    return message
