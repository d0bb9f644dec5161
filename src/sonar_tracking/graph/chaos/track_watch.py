"""Watches the tracks of a run from outside, and sends what it should not get."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from statistics import median
from typing import Any

import numpy as np
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions

from sonar_tracking.graph.catalogue.topics import TRUE_BEARING_TRACKS, TRUE_TRACKS, Topic
from sonar_tracking.graph.chaos.fault_plan import MALFORMED_MESSAGES
from sonar_tracking.graph.chaos.message_mutation import mutated
from sonar_tracking.graph.chaos.track_identities import LISTS, SEEN, Place, TrackList
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.message_reading.field_reading import stamp_from_time

DEPTH = 1000


class TrackWatch:
    """Subscribes to lists of tracks, to the truth, and to the inputs of nodes.

    Parameters
    ----------
    tracks : Topic
        Lists of tracks.
    inputs : sequence of Topic
        What malformed messages are made from.

    Attributes
    ----------
    lists, truth : list of TrackList
        What has come, in order.
    """

    def __init__(self, tracks: Topic, inputs: Sequence[Topic]) -> None:
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = Node("chaos", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self.lists: list[TrackList] = []
        self.truth: list[TrackList] = []
        self._latest: dict[str, bytes] = {}
        self._inputs = {topic.name: topic for topic in inputs}
        true = TRUE_TRACKS if tracks.message_type == TRUE_TRACKS.message_type else None
        for topic, lists in ((tracks, self.lists), (true or TRUE_BEARING_TRACKS, self.truth)):
            self._subscribe(topic, partial(_take, lists), raw=False)
        for topic in inputs:
            self._subscribe(topic, partial(self._latest.__setitem__, topic.name), raw=True)

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
        kind = message_class(topic.message_type)
        profile = quality_of_service.publisher_profile(topic.kind, DEPTH)
        publisher = self._node.create_publisher(kind, name, profile)
        self.spin(1.0)
        generator = np.random.default_rng(seed)
        for _ in range(MALFORMED_MESSAGES):
            good = deserialize_message(self._latest[name], kind)
            publisher.publish(mutated(good, generator))
            self.spin(0.02)
        self._node.destroy_publisher(publisher)
        return MALFORMED_MESSAGES

    @property
    def steady(self) -> bool:
        """Whether the last lists have confirmed tracks."""
        recent = self.lists[-LISTS:]
        return len(recent) == LISTS and sum(bool(each.places) for each in recent) >= SEEN

    @property
    def interval(self) -> float:
        """Usual time between two lists, s of the wall clock; 0 = not known."""
        walls = [each.wall for each in self.lists[-LISTS - 1 :]]
        return median(np.diff(walls)) if len(walls) > 1 else 0.0

    @property
    def due(self) -> float:
        """When the next list was to come, s of the monotonic clock."""
        return self.lists[-1].wall + self.interval if self.lists else 0.0

    def close(self) -> None:
        """End the node."""
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _subscribe(self, topic: Topic, take: Callable[[Any], None], raw: bool) -> None:
        kind = message_class(topic.message_type)
        profile = quality_of_service.subscription_profile(DEPTH)
        self._node.create_subscription(kind, topic.name, take, profile, raw=raw)


def track_list(message: Any, wall: float = 0.0) -> TrackList:
    """Return where the confirmed tracks of a message are; wall time in s, when it came."""
    angles = hasattr(message, "arrival_angle")
    columns = [message.arrival_angle] if angles else [message.x, message.y]
    status = message.status or [message.CONFIRMED] * len(message.id)
    places: dict[int, list[Place]] = {}
    for name, state, *place in zip(message.id, status, *columns, strict=False):
        if state == message.CONFIRMED:
            places.setdefault(int(name), []).append(tuple(map(float, place)))
    return TrackList(wall, stamp_from_time(message.header.stamp), places)


def _take(lists: list[TrackList], message: Any) -> None:
    lists.append(track_list(message, time.monotonic()))
