"""Node ``scene_publisher``: own ship, sensors and what they hear, for RViz and Foxglove.

It listens like any visitor: nobody waits for it, and it reports no progress. A picture more is one
more subscription in the constructor, and one method that turns a message into a picture.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import deserialize_message

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.errors import InputError, Severity
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_MARKERS,
    ACTIVE_THRESHOLD,
    ACTIVE_TRACKS,
    BEARING_MARKERS,
    BEARING_TRACKS,
    CONTACT_MARKERS,
    CONTACT_POINTS,
    CONTACTS,
    DIAGNOSTICS_TOPIC,
    FIXED_TRANSFORMS,
    FUSED_MARKERS,
    FUSED_TRACKS,
    GATE_MARKERS,
    ODOMETRY,
    PASSIVE_MARKERS,
    PASSIVE_TRACKS,
    TRANSFORMS,
    Topic,
    TopicKind,
)
from sonar_tracking.graph.message_writing.bearing_marker_writing import bearing_markers
from sonar_tracking.graph.message_writing.contact_marker_writing import (
    contact_markers,
    gate_markers,
)
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.message_writing.point_cloud_writing import contact_points_to_message
from sonar_tracking.graph.message_writing.position_marker_writing import position_markers
from sonar_tracking.graph.message_writing.transform_writing import transforms_to_message
from sonar_tracking.graph.node_base import parameters, quality_of_service
from sonar_tracking.graph.node_base.changeable_parameters import ChangeableParameters
from sonar_tracking.graph.node_base.diagnostics import MATCHED, Diagnostics, kind_of
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.node_watch import STATUS_PERIOD
from sonar_tracking.graph.node_base.ready_reports import ReadyReports
from sonar_tracking.message_reading.array_reading import directions_from_message
from sonar_tracking.message_reading.contact_reading import (
    contacts_from_message,
    thresholds_from_message,
)
from sonar_tracking.message_reading.field_reading import sensor, stamp_from_time
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.message_reading.pose_reading import own_ship_pose_from_message
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.motion import KinematicState
from sonar_tracking.own_ship_interpolation import motion_in_map
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.scene.rigid_pose import RigidPose, turned_about_z
from sonar_tracking.scene.scene_configuration import SceneConfiguration
from sonar_tracking.scene.scene_frames import FrameTransform, HeardSensor, SceneFrames
from sonar_tracking.scene.scene_hearing import (
    HeardStations,
    contacts_need_own_ship,
    located_contacts,
)
from sonar_tracking.scene.told_mountings import array_as_told, sonar_as_told
from sonar_tracking.scene.waiting_for_own_ship import WaitingForOwnShip

Draw = Callable[[KinematicState | None], None]
"""Takes own ship's motion, if known, and publishes pictures."""

DEPTH = 1000
"""Messages kept per topic: the scene may fall behind the data for a while."""

AUDIENCE_PERIOD = 0.05
"""Between two looks whether anybody looks at the pictures, s of steady time."""


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
        self._configuration = configuration
        ChangeableParameters(self, configuration, bool, self._take)
        name = self.get_fully_qualified_name().lstrip("/")
        reports = self.create_publisher(
            DiagnosticArray, DIAGNOSTICS_TOPIC, quality_of_service.DIAGNOSTICS
        )
        self._diagnostics = Diagnostics(name, self.get_logger(), reports.publish)
        self._received: dict[str, int] = {}
        self._asked, self._audience = -AUDIENCE_PERIOD, False
        self._own_ship = OwnShipReader()
        self._station = configuration.station
        places = filter(None, (self.get_namespace().strip("/"), self._station))
        self._frames = SceneFrames("".join(f"{place}/" for place in places))
        self._fixed: tuple[FrameTransform, ...] = ()
        self._pictures = {topic: self._publisher(topic) for topic in SCENE_PUBLISHER.markers}
        self._transforms = self._pictures[TRANSFORMS]
        self._fixed_transforms = self._pictures[FIXED_TRANSFORMS]
        self._waiting: WaitingForOwnShip[tuple[int, Draw]] = WaitingForOwnShip()
        self._sonar, self._array = _mountings(configuration)
        self._stations = HeardStations(array_as_told(configuration))
        self._listen_below(ODOMETRY, self._show_own_ship)
        self._listen_below(CONTACTS, self._show_contacts)
        self._listen_below(ACTIVE_THRESHOLD, self._show_gates)
        self._listen_below(ACTIVE_TRACKS, partial(self._show_tracks, ACTIVE_MARKERS))
        self._listen_below(PASSIVE_TRACKS, partial(self._show_tracks, PASSIVE_MARKERS))
        self._listen_below(FUSED_TRACKS, partial(self._show_tracks, FUSED_MARKERS))
        for topic in filter(None, configuration.bearing_topics):
            self._listen(replace(BEARING_TRACKS, name=topic), self._show_bearings)
        self._diagnostics.add(MATCHED, self._matched)
        ReadyReports(self, self._diagnostics, self._matched, lambda: any(self._received.values()))
        # Nothing here needs the clock of the data, each tick of which costs as much as a picture.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(STATUS_PERIOD, self._diagnostics.publish, clock=steady)

    def _publisher(self, topic: Topic) -> Publisher:
        """Return a publisher of pictures; of those for late readers, the last one is kept."""
        depth = 1 if topic.kind is TopicKind.TRACKS else DEPTH
        profile = quality_of_service.publisher_profile(topic.kind, depth)
        name = topic.below(self._station).name
        return self.create_publisher(message_class(topic.message_type), name, profile)

    def _listen_below(self, topic: Topic, show: Callable[[Any], None]) -> None:
        """Let every message of a topic of the ship that is shown be shown."""
        self._listen(topic.below(self._station), show)

    def _listen(self, topic: Topic, show: Callable[[Any], None]) -> None:
        """Let every message of a topic be shown; what cannot be read is left out, and said.

        While nobody looks at any picture messages are not even decoded: that is most of the cost.
        """

        def receive(data: bytes) -> None:
            self._received[name] += 1
            self._diagnostics.advance(head_stamp(data))
            if not self._has_audience():
                return
            try:
                show(deserialize_message(data, kind))
            except InputError as error:
                sentence = f"{name}: not shown: {error}"
                self._diagnostics.report(
                    f"input {name}", kind_of(str(error)), Severity.WARN, sentence
                )

        profile = quality_of_service.subscription_profile(DEPTH)
        kind = message_class(topic.message_type)
        subscription = self.create_subscription(kind, topic.name, receive, profile, raw=True)
        name: str = subscription.topic_name
        self._received[name] = 0

    def _show_own_ship(self, message: Any) -> None:
        own_ship = own_ship_pose_from_message(message, self._own_ship(message))
        frames = message.header.frame_id, message.child_frame_id
        self._publish(self._frames.own_ship_told(own_ship, *frames))
        for stamp, draw in self._waiting.released(own_ship.state.stamp):
            draw(self._motion_at(stamp))

    def _show_contacts(self, message: Any) -> None:
        self._show_sensor(message, self._sonar)
        if self._is_watched(CONTACT_MARKERS) or self._is_watched(CONTACT_POINTS):
            contacts = contacts_from_message(message)
            waits = contacts_need_own_ship(contacts)
            self._draw_located(contacts.stamp, waits, partial(self._draw_contacts, contacts))

    def _draw_contacts(self, contacts: Contacts, own_ship: KinematicState | None) -> None:
        settings = self._configuration
        mounting = sonar_as_told(settings)
        odometry = self._expects_odometry()
        found = located_contacts(contacts, own_ship, mounting, odometry, settings.sound_speed)
        self._show(CONTACT_MARKERS, lambda: contact_markers(*found, settings.marker_size))
        self._show(CONTACT_POINTS, lambda: contact_points_to_message(*found))

    def _show_bearings(self, message: Any) -> None:
        self._show_sensor(message, self._array)
        if self._is_watched(BEARING_MARKERS):
            tracks = directions_from_message(message)
            waits = self._stations.needs_own_ship(tracks)
            self._draw_located(tracks.stamp, waits, partial(self._draw_bearings, tracks))

    def _draw_bearings(self, tracks: BearingTracks, own_ship: KinematicState | None) -> None:
        self._stations.take(tracks, own_ship, self._expects_odometry())
        heard, settings = self._stations.heard, self._configuration
        size, length = settings.marker_size, settings.ray_length
        self._show(BEARING_MARKERS, lambda: bearing_markers(heard, tracks.stamp, length, size))

    def _show_gates(self, message: Any) -> None:
        size = self._configuration.marker_size
        self._show(GATE_MARKERS, lambda: gate_markers(thresholds_from_message(message), size))

    def _show_tracks(self, topic: Topic, message: Any) -> None:
        size = self._configuration.marker_size
        self._show(topic, lambda: position_markers(position_tracks_from_message(message), size))

    def _show(self, topic: Topic, picture: Callable[[], Any]) -> None:
        """Publish a picture, which is not drawn while nobody looks at it."""
        if self._is_watched(topic):
            self._pictures[topic].publish(picture())

    def _has_audience(self) -> bool:
        """Return whether anybody looks at any picture; asked again after a moment."""
        now = time.monotonic()
        if now >= self._asked + AUDIENCE_PERIOD:
            self._asked = now
            self._audience = any(map(self._is_watched, self._pictures))
        return self._audience

    def _is_watched(self, topic: Topic) -> bool:
        return self._pictures[topic].get_subscription_count() > 0

    def _draw_located(self, stamp: int, needs_own_ship: bool, draw: Draw) -> None:
        """Draw now, or when odometry has come as far as the stamp."""
        known = self._frames.knows_own_ship(stamp)
        if needs_own_ship and not known and self._expects_odometry():
            self._waiting.keep(stamp, (stamp, draw))
        else:
            draw(self._motion_at(stamp))

    def _motion_at(self, stamp: int) -> KinematicState | None:
        own_ship = self._frames.own_ship_at(stamp)
        return None if own_ship is None else motion_in_map(own_ship.state)

    def _take(self, configuration: SceneConfiguration) -> None:
        self._configuration = configuration

    def _show_sensor(self, message: Any, mounting: RigidPose) -> None:
        stamp = stamp_from_time(message.header.stamp)
        heard = HeardSensor(stamp, sensor(message), mounting)
        self._publish(self._frames.sensor_told(heard, self._expects_odometry()))

    def _publish(self, moving: list[FrameTransform]) -> None:
        if moving and self._is_watched(TRANSFORMS):
            self._transforms.publish(transforms_to_message(moving))
        fixed = tuple(self._frames.fixed.values())
        if fixed != self._fixed:
            self._fixed = fixed
            # Late readers get the last message only, so that each one holds all.
            self._fixed_transforms.publish(transforms_to_message(fixed))

    def _expects_odometry(self) -> bool:
        """Return whether own ship's motion is known, or somebody may publish it."""
        name = self.resolve_topic_name(ODOMETRY.below(self._station).name)
        return self._received[name] > 0 or self.count_publishers(name) > 0

    def _matched(self) -> dict[str, object]:
        """Return the matched remote endpoints of every topic."""
        return {
            **{
                each.topic_name: each.get_publisher_count()
                for each in self.subscriptions
                if each.topic_name in self._received
            },
            **{each.topic_name: each.get_subscription_count() for each in self._pictures.values()},
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
