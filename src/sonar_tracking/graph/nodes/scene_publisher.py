"""Node ``scene_publisher``: own ship, sensors and what they hear, for RViz and Foxglove.

It listens like any visitor: nobody waits for it, and it reports no progress. A picture more is one
more subscription in the constructor, and one method that turns a message into a picture.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.publisher import Publisher

from sonar_tracking.errors import InputError, Severity
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    CONTACTS,
    DIAGNOSTICS_TOPIC,
    FIXED_TRANSFORMS,
    ODOMETRY,
    TRANSFORMS,
    Topic,
    TopicKind,
)
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.message_writing.transform_writing import transforms_to_message
from sonar_tracking.graph.node_base import parameters, quality_of_service
from sonar_tracking.graph.node_base.diagnostics import MATCHED, Diagnostics, kind_of
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.node_watch import STATUS_PERIOD
from sonar_tracking.graph.node_base.ready_reports import ReadyReports
from sonar_tracking.message_reading.field_reading import sensor, stamp_from_time
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.message_reading.pose_reading import own_ship_pose_from_message
from sonar_tracking.scene.rigid_pose import RigidPose, turned_about_z
from sonar_tracking.scene.scene_configuration import SceneConfiguration
from sonar_tracking.scene.scene_frames import FrameTransform, HeardSensor, SceneFrames

DEPTH = 1000
"""Messages kept per topic: the scene may fall behind the data for a while."""


class ScenePublisher(Node):
    """Shell around :class:`sonar_tracking.scene.scene_frames.SceneFrames`.

    Messages that cannot be read are left to the trackers, which report them as errors; here they
    are a warning.
    """

    def __init__(self) -> None:
        super().__init__(SCENE_PUBLISHER.name)
        given = parameters.overrides_of(self)
        parameters.check_overrides(SCENE_PUBLISHER.configurations, given, self.get_name())
        configuration = parameters.resolve(SceneConfiguration, given, self.get_name())
        parameters.declare(self, configuration)
        name = self.get_fully_qualified_name().lstrip("/")
        reports = self.create_publisher(
            DiagnosticArray, DIAGNOSTICS_TOPIC, quality_of_service.DIAGNOSTICS
        )
        self._diagnostics = Diagnostics(name, self.get_logger(), reports.publish)
        self._received: dict[str, int] = {}
        self._own_ship = OwnShipReader()
        namespace = self.get_namespace().strip("/")
        self._frames = SceneFrames(namespace and f"{namespace}/")
        self._fixed: tuple[FrameTransform, ...] = ()
        self._transforms = self._publisher(TRANSFORMS)
        self._fixed_transforms = self._publisher(FIXED_TRANSFORMS)
        sonar, array = _mountings(configuration)
        self._listen(ODOMETRY, self._show_own_ship)
        self._listen(CONTACTS, lambda message: self._show_sensor(message, sonar))
        for topic in filter(None, configuration.bearing_topics):
            self._listen(
                replace(BEARING_TRACKS, name=topic),
                lambda message: self._show_sensor(message, array),
            )
        self._diagnostics.add(MATCHED, self._matched)
        ReadyReports(self, self._diagnostics, self._matched, lambda: any(self._received.values()))
        self.create_timer(STATUS_PERIOD, self._diagnostics.publish)

    def _publisher(self, topic: Topic) -> Publisher:
        """Return a publisher of pictures; of those for late readers, the last one is kept."""
        depth = 1 if topic.kind is TopicKind.TRACKS else DEPTH
        profile = quality_of_service.publisher_profile(topic.kind, depth)
        return self.create_publisher(message_class(topic.message_type), topic.name, profile)

    def _listen(self, topic: Topic, show: Callable[[Any], None]) -> None:
        """Let every message of a topic be shown; what cannot be read is left out, and said."""

        def receive(message: Any) -> None:
            self._received[name] += 1
            self._diagnostics.advance(stamp_from_time(message.header.stamp))
            try:
                show(message)
            except InputError as error:
                sentence = f"{name}: not shown: {error}"
                self._diagnostics.report(
                    f"input {name}", kind_of(str(error)), Severity.WARN, sentence
                )

        profile = quality_of_service.subscription_profile(DEPTH)
        kind = message_class(topic.message_type)
        name: str = self.create_subscription(kind, topic.name, receive, profile).topic_name
        self._received[name] = 0

    def _show_own_ship(self, message: Any) -> None:
        own_ship = own_ship_pose_from_message(message, self._own_ship(message))
        frames = message.header.frame_id, message.child_frame_id
        self._publish(self._frames.own_ship_told(own_ship, *frames))

    def _show_sensor(self, message: Any, mounting: RigidPose) -> None:
        stamp = stamp_from_time(message.header.stamp)
        heard = HeardSensor(stamp, sensor(message), mounting)
        self._publish(self._frames.sensor_told(heard, self._expects_odometry()))

    def _publish(self, moving: list[FrameTransform]) -> None:
        if moving:
            self._transforms.publish(transforms_to_message(moving))
        fixed = tuple(self._frames.fixed.values())
        if fixed != self._fixed:
            self._fixed = fixed
            # Late readers get the last message only, so that each one holds all.
            self._fixed_transforms.publish(transforms_to_message(fixed))

    def _expects_odometry(self) -> bool:
        """Return whether own ship's motion is known, or somebody may publish it."""
        name = self.resolve_topic_name(ODOMETRY.name)
        return self._received[name] > 0 or self.count_publishers(name) > 0

    def _matched(self) -> dict[str, object]:
        """Return the matched remote endpoints of every topic."""
        return {
            **{
                each.topic_name: each.get_publisher_count()
                for each in self.subscriptions
                if each.topic_name in self._received
            },
            **{
                each.topic_name: each.get_subscription_count()
                for each in (self._transforms, self._fixed_transforms)
            },
        }


def _mountings(configuration: SceneConfiguration) -> tuple[RigidPose, RigidPose]:
    """Return where the active sonar and an array are on own ship."""
    sonar = (configuration.sonar_mounting_x, configuration.sonar_mounting_y, 0.0)
    array = (configuration.array_mounting_x, configuration.array_mounting_y, 0.0)
    return (
        RigidPose(sonar, turned_about_z(math.radians(configuration.sonar_mounting_yaw_deg))),
        RigidPose(array, turned_about_z(math.radians(configuration.array_mounting_yaw_deg))),
    )


def main() -> int:
    """Run the node."""
    return run_node(ScenePublisher)


if __name__ == "__main__":
    sys.exit(main())
