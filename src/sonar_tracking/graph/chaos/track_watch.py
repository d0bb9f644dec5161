"""Watches the tracks of a run from outside, and sends what it should not get."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from sonar_tracking.graph.catalogue.topics import Topic
from sonar_tracking.graph.chaos.fault_plan import MALFORMED_MESSAGES
from sonar_tracking.graph.chaos.message_mutation import mutated
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service

DEPTH = 100


class TrackWatch:
    """Subscribes to lists of tracks and to the inputs of nodes.

    Parameters
    ----------
    tracks : Topic
        Lists of tracks.
    inputs : sequence of Topic
        What malformed messages are made from.
    """

    def __init__(self, tracks: Topic, inputs: Sequence[Topic]) -> None:
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = Node("chaos", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self.lists: list[tuple[float, set[int]]] = []
        self._latest: dict[str, Any] = {}
        self._inputs = {topic.name: topic for topic in inputs}
        profile = quality_of_service.subscription_profile(DEPTH)
        kind = message_class(tracks.message_type)
        self._node.create_subscription(kind, tracks.name, self._take, profile)
        for topic in inputs:
            self._node.create_subscription(
                message_class(topic.message_type),
                topic.name,
                partial(self._keep, topic.name),
                profile,
            )

    def spin(self, seconds: float) -> None:
        """Take what has come, for a while of the wall clock."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def send_malformed(self, name: str, seed: int) -> int:
        """Publish malformed messages on a topic and return their number; 0 = it was silent."""
        if name not in self._latest:
            return 0
        topic = self._inputs[name]
        publisher = self._node.create_publisher(
            message_class(topic.message_type),
            name,
            quality_of_service.publisher_profile(topic.kind, DEPTH),
        )
        self.spin(1.0)
        generator = np.random.default_rng(seed)
        for _ in range(MALFORMED_MESSAGES):
            publisher.publish(mutated(self._latest[name], generator))
            self.spin(0.02)
        self._node.destroy_publisher(publisher)
        return MALFORMED_MESSAGES

    def confirmed(self) -> set[int]:
        """Return the tracks that the last list confirms."""
        return self.lists[-1][1] if self.lists else set()

    def close(self) -> None:
        """End the node."""
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _keep(self, name: str, message: Any) -> None:
        self._latest[name] = message

    def _take(self, message: Any) -> None:
        status = np.asarray(message.status)
        rows = np.asarray(message.id)[status == message.CONFIRMED] if len(status) else ()
        self.lists.append((time.monotonic(), {int(number) for number in rows}))
