"""Commands of operators to messages.

The other way is :mod:`sonar_tracking.message_reading.command_reading`.
"""

from __future__ import annotations

from rclpy.serialization import serialize_message
from sonar_tracking_msgs.msg import OperatorCommand as OperatorCommandMessage

from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.records.commands import OperatorCommand
from sonar_tracking.records.positions import MAP_FRAME


def command_to_message(record: OperatorCommand) -> OperatorCommandMessage:
    """Return what an operator tells the trackers as a message."""
    message = OperatorCommandMessage()
    message.header.stamp = time_from_stamp(record.stamp)
    message.header.frame_id = MAP_FRAME
    message.command = int(record.kind)
    message.topic = record.topic
    message.id, message.other_id = record.id, record.other_id
    message.arrival_angle = float(record.arrival_angle)
    message.x, message.y = map(float, record.position)
    message.side = int(record.side)
    message.frequency = float(record.line.frequency)
    message.bandwidth = float(record.line.bandwidth)
    message.sensor_id = record.line.sensor_id
    message.name = record.name
    return message


def command_bytes(record: OperatorCommand) -> bytes:
    """Return what an operator tells the trackers as a serialised message."""
    data: bytes = serialize_message(command_to_message(record))
    return data
