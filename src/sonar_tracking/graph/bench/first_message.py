"""When the first message of a topic reaches a subscriber of another process."""

from __future__ import annotations

import os
import time

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from sonar_tracking.graph.catalogue.discovery_range import default_range
from sonar_tracking.graph.catalogue.topics import Topic
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service


class FirstMessage:
    """Subscribes until a message has come, and does nothing from then on.

    Parameters
    ----------
    topic : Topic
        Which one.

    Attributes
    ----------
    wall : float or None
        When it came, s of the monotonic clock.
    """

    def __init__(self, topic: Topic) -> None:
        os.environ.update(default_range())
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = Node("bench", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self.wall: float | None = None
        self._node.create_subscription(
            message_class(topic.message_type),
            topic.name,
            self._take,
            quality_of_service.subscription_profile(1),
            raw=True,
        )

    def wait(self, seconds: float) -> None:
        """Wait a while of the wall clock, or until the message has come."""
        if self._context.ok():
            self._executor.spin_once(timeout_sec=seconds)
        else:
            time.sleep(seconds)
        if self.wall is not None:
            self.close()

    def close(self) -> None:
        """End the subscription; again does nothing."""
        if self._context.ok():
            self._executor.shutdown()
            self._node.destroy_node()
            rclpy.try_shutdown(context=self._context)

    def _take(self, _: bytes) -> None:
        self.wall = self.wall or time.monotonic()
