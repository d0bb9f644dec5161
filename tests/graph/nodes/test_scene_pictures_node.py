"""A live scene_publisher: pictures of what is heard and tracked, where it is, for who looks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from sonar_tracking_msgs.msg import BearingTracks as BearingTracksMessage
from sonar_tracking_msgs.msg import Contacts as ContactsMessage
from sonar_tracking_msgs.msg import DetectionThreshold, Tracks
from visualization_msgs.msg import Marker

from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_MARKERS,
    ACTIVE_THRESHOLD,
    ACTIVE_TRACKS,
    BEARING_MARKERS,
    BEARING_TRACKS,
    CONTACT_MARKERS,
    CONTACT_POINTS,
    CONTACTS,
    FUSED_MARKERS,
    FUSED_TRACKS,
    GATE_MARKERS,
    ODOMETRY,
    PASSIVE_MARKERS,
    PASSIVE_TRACKS,
)
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.graph.message_writing.field_writing import set_vector, time_from_stamp
from sonar_tracking.records.own_ship import OwnShipState
from tests.graph.live_graph import Probe, node_process, stamps

NODE = "scene_publisher"
SECOND = 1_000_000_000
EPOCH = 1_767_225_600 * SECOND
PICTURES = (
    BEARING_MARKERS,
    CONTACT_MARKERS,
    CONTACT_POINTS,
    GATE_MARKERS,
    ACTIVE_MARKERS,
    FUSED_MARKERS,
)
"""All but one, which nobody looks at in the beginning."""


class Scene:
    """A live scene and the means to feed it: a ship that goes east at 5 m/s from x = 1000 m."""

    def __init__(self, probe: Probe) -> None:
        self.probe = probe
        self.heard: dict[str, list[Any]] = {topic.name: probe.listen(topic) for topic in PICTURES}
        self._publishers = {
            topic.name: probe.publisher(topic)
            for topic in (
                *(ODOMETRY, CONTACTS, BEARING_TRACKS),
                *(ACTIVE_THRESHOLD, ACTIVE_TRACKS, PASSIVE_TRACKS, FUSED_TRACKS),
            )
        }

    def send(self, topic: Any, message: Any, second: int) -> None:
        """Publish a message of a second of the run."""
        message.header.stamp = time_from_stamp(EPOCH + second * SECOND)
        self._publishers[topic.name].publish(message)

    def own_ship(self, second: int) -> None:
        """Publish where own ship is."""
        state = OwnShipState(EPOCH, (1000.0 + 5.0 * second, 0.0), 0.0, (5.0, 0.0), 0.0)
        self.send(ODOMETRY, array_writing.own_ship_to_message(state), second)

    def picture(self, topic: Any, second: int) -> Any:
        """Wait for the picture of a second."""
        heard, stamp = self.heard[topic.name], EPOCH + second * SECOND
        self.probe.wait(lambda: stamp in stamps_of(heard), f"{topic.name} of second {second}")
        return heard[stamps_of(heard).index(stamp)]


def stamps_of(heard: list[Any]) -> list[int]:
    """Return the stamps of pictures; those of markers are in their first one."""
    return stamps([getattr(each, "markers", [each])[0] for each in heard])


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Scene]:
    log = tmp_path_factory.mktemp("scene") / "log.txt"
    probe = Probe()
    parameters = {"use_sim_time": True, "ray_length": 1000.0, "sound_speed": 0.0}
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters):
        started = Scene(probe)
        topics = (ODOMETRY, CONTACTS, BEARING_TRACKS, ACTIVE_THRESHOLD, ACTIVE_TRACKS)
        probe.wait_matched(NODE, *(f"/{topic.name}" for topic in (*topics, *PICTURES)))
        yield started
    probe.close()


def ping() -> ContactsMessage:
    """Return a ping of somebody who fills in nothing but what he has heard."""
    message = ContactsMessage(range=[500.0, np.nan], azimuth=[np.pi / 2.0, 0.0])
    message.amplitude = [10.0, 20.0]
    message.header.frame_id = "own_ship/base_link"
    return message


def named(picture: Any) -> dict[str, Marker]:
    """Return the markers after the first by their namespaces."""
    assert picture.markers[0].action == Marker.DELETEALL
    return {marker.ns: marker for marker in picture.markers[1:]}


def test_what_nobody_looks_at_is_not_drawn(scene: Scene) -> None:
    """A list that cannot be read is not noticed before somebody wants to see it."""
    unequal = Tracks(id=[5], x=[0.0, 1.0])
    scene.send(PASSIVE_TRACKS, unequal, 0)
    scene.send(ACTIVE_TRACKS, Tracks(), 0)
    scene.picture(ACTIVE_MARKERS, 0)
    scene.probe.wait_sentence(f"{NODE}: matched")
    concern = f"{NODE}: input /passive/tracks"
    assert not scene.probe.sentences(concern)
    scene.heard[PASSIVE_MARKERS.name] = scene.probe.listen(PASSIVE_MARKERS)
    scene.probe.wait_matched(NODE, f"/{PASSIVE_MARKERS.name}")
    scene.send(PASSIVE_TRACKS, unequal, 1)
    scene.probe.wait_sentence(concern, "not shown")


def test_contacts_are_shown_from_where_own_ship_was(scene: Scene) -> None:
    scene.own_ship(0)
    scene.send(CONTACTS, ping(), 3)
    scene.own_ship(10)
    # After 3 s the ship is at 1015 m; 500 m to port is north of it.
    contacts = named(scene.picture(CONTACT_MARKERS, 3))["contacts"]
    ((x, y),) = [(point.x, point.y) for point in contacts.points]
    assert (x, y) == pytest.approx((1015.0, 500.0))
    cloud = scene.picture(CONTACT_POINTS, 3)
    assert (cloud.width, cloud.header.frame_id) == (1, "map")
    values = np.frombuffer(bytes(cloud.data), np.float32)
    assert values == pytest.approx([1015.0, 500.0, 0.0, 10.0, 500.0, np.pi / 2.0], rel=1e-6)


def test_bearings_are_rays_from_where_own_ship_was(scene: Scene) -> None:
    scene.own_ship(20)
    message = BearingTracksMessage(sensor_id="array", id=[4], arrival_angle=[0.0])
    message.header.frame_id = "own_ship/array"
    set_vector(message.sensor_pose.position, (np.nan, np.nan, np.nan))
    scene.send(BEARING_TRACKS, message, 24)
    scene.own_ship(30)
    markers = named(scene.picture(BEARING_MARKERS, 24))
    assert set(markers) == {f"array/{w}_{s}" for w in ("ray", "name") for s in ("left", "right")}
    start, end = markers["array/ray_left"].points
    assert (start.x, start.y) == pytest.approx((1120.0, 0.0))
    assert (end.x, end.y) == pytest.approx((1120.0, 1000.0))


def test_tracks_and_gates_are_shown_as_they_come(scene: Scene) -> None:
    tracks = Tracks(id=[5], x=[100.0], y=[200.0], vx=[1.0], vy=[0.0], status=[Tracks.CONFIRMED])
    tracks.header.frame_id = "map"
    pictures = {
        ACTIVE_TRACKS: ACTIVE_MARKERS,
        PASSIVE_TRACKS: PASSIVE_MARKERS,
        FUSED_TRACKS: FUSED_MARKERS,
    }
    for topic, picture in pictures.items():
        scene.send(topic, tracks, 31)
        markers = named(scene.picture(picture, 31))
        assert markers["name"].text == "5"
        assert markers["position"].pose.position.x == 100.0
    gates = DetectionThreshold(track_id=[5], threshold=[10.0], predicted_x=[100.0])
    gates.predicted_y, gates.gate_covariance = [200.0], [100.0, 0.0, 0.0, 25.0]
    scene.send(ACTIVE_THRESHOLD, gates, 31)
    markers = named(scene.picture(GATE_MARKERS, 31))
    assert max(point.x for point in markers["gate"].points) == pytest.approx(140.0)
    assert markers["threshold"].text == "10.0 dB"


def test_what_cannot_be_read_or_is_of_no_kind_known_stops_nothing(scene: Scene) -> None:
    unequal = ping()
    unequal.azimuth = [0.0]
    strange = Tracks(id=[5], x=[0.0], y=[0.0], vx=[0.0], vy=[0.0], status=[77], hypothesis=[77])
    scene.own_ship(40)
    scene.send(CONTACTS, unequal, 40)
    scene.send(ACTIVE_TRACKS, strange, 40)
    assert not named(scene.picture(ACTIVE_MARKERS, 40))
    scene.probe.wait_sentence(f"{NODE}: input /active/contacts", "not shown", "azimuth")
    scene.send(CONTACTS, ping(), 40)
    assert named(scene.picture(CONTACT_MARKERS, 40))


def test_sizes_are_changed_while_it_runs(scene: Scene) -> None:
    client = AsyncParameterClient(scene.probe.node, NODE)
    changed = client.set_parameters([Parameter("marker_size", value=10.0)])
    scene.probe.wait(changed.done, "the parameter")
    assert all(result.successful for result in changed.result().results)
    tracks = Tracks(id=[5], x=[1.0], y=[2.0], vx=[0.0], vy=[0.0], status=[Tracks.CONFIRMED])
    scene.send(ACTIVE_TRACKS, tracks, 50)
    assert named(scene.picture(ACTIVE_MARKERS, 50))["position"].scale.x == 10.0
