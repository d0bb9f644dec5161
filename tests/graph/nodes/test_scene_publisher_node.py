"""A live publisher of the scene: frames for late readers, and no part in the flow of data."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    CONTACTS,
    FIXED_TRANSFORMS,
    ODOMETRY,
    TRANSFORMS,
)
from sonar_tracking.graph.message_writing.array_writing import (
    own_ship_to_message,
)
from sonar_tracking.graph.message_writing.contact_writing import contacts_to_message
from sonar_tracking.graph.message_writing.field_writing import message_class, set_sensor
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.message_reading.array_reading import bearing_tracks_from_message
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from tests.graph.live_graph import NodeProcess, Probe, node_process

NODE = "scene_publisher"
SECOND = 1_000_000_000
NORTH = math.pi / 2.0


class Scene:
    """The node, what is sent to it, and what it shows."""

    def __init__(self, probe: Probe, process: NodeProcess) -> None:
        self.probe, self.process = probe, process
        self.moving = probe.listen(TRANSFORMS)
        self.odometry = probe.publisher(ODOMETRY)
        self.contacts = probe.publisher(CONTACTS)
        self.bearings = probe.publisher(BEARING_TRACKS)

    def late_reader(self) -> list[Any]:
        """Return what somebody hears of the fixed frames who comes now."""
        heard: list[Any] = []
        self.probe.node.create_subscription(
            message_class(FIXED_TRANSFORMS.message_type),
            FIXED_TRANSFORMS.name,
            heard.append,
            quality_of_service.LATE_READER,
        )
        return heard


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Scene]:
    log = tmp_path_factory.mktemp("scene") / "log.txt"
    parameters = {"array_mounting_x": -300.0, "array_mounting_yaw_deg": 180.0}
    probe = Probe()
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        found = Scene(probe, process)
        topics = ("/own_ship/odometry", "/active/contacts", "/passive/bearing_tracks", "/tf")
        probe.wait_matched(NODE, *topics)
        yield found
    probe.close()


def bearings(stamp: int) -> Any:
    """Return no bearings, of an array that does not tell its pose."""
    message = message_class(BEARING_TRACKS.message_type)()
    set_sensor(message, Sensor("towed", "own_ship/towed"))
    message.header.stamp.sec = stamp // SECOND
    assert len(bearing_tracks_from_message(message).id) == 0
    return message


def test_own_ship_and_its_sensors_make_one_tree_and_late_readers_get_it(scene: Scene) -> None:
    start = 100 * SECOND
    empty = np.empty(0)
    scene.bearings.publish(bearings(start))
    sonar = Contacts(start, empty, empty, empty, 1.0, 0.01, (0.0, 50.0), (0.0, 4.0))
    scene.contacts.publish(contacts_to_message(sonar))
    for second in range(2):
        state = OwnShipState(start + second * SECOND, (0.0, 4.0 * second), NORTH, (4.0, 0.0), 0.0)
        scene.odometry.publish(own_ship_to_message(state))
    scene.probe.wait_for_count(scene.moving.__len__, 2, "poses of own ship")
    told = [transform for message in scene.moving for transform in message.transforms]
    assert {(each.header.frame_id, each.child_frame_id) for each in told} == {
        ("map", "own_ship/base_link")
    }
    assert [each.transform.translation.y for each in told] == [0.0, 4.0]

    late = scene.late_reader()
    scene.probe.wait(lambda: late and len(late[-1].transforms) == 2, "fixed frames, all at once")
    fixed = {each.child_frame_id: each for each in late[-1].transforms}
    assert {each.header.frame_id for each in fixed.values()} == {"own_ship/base_link"}
    towed, bow = fixed["own_ship/towed"].transform, fixed["own_ship/sonar"].transform
    assert (towed.translation.x, towed.translation.y) == (-300.0, 0.0)
    assert (towed.rotation.z, towed.rotation.w) == pytest.approx((1.0, 0.0))
    assert (bow.translation.x, bow.translation.y) == pytest.approx((50.0, 0.0))


def test_a_message_that_cannot_be_shown_is_told_and_the_next_one_is_shown(scene: Scene) -> None:
    before = len(scene.moving)
    state = OwnShipState(200 * SECOND, (0.0, 0.0), NORTH, (4.0, 0.0), 0.0)
    broken = own_ship_to_message(state)
    broken.pose.pose.position.x = math.nan
    scene.odometry.publish(broken)
    scene.probe.wait_sentence(f"{NODE}: input /own_ship/odometry", "not shown", "not a finite")
    scene.odometry.publish(own_ship_to_message(state))
    scene.probe.wait_for_count(scene.moving.__len__, before + 1, "poses of own ship")
    assert scene.process.is_alive


def test_nobody_waits_for_it(scene: Scene) -> None:
    assert not [message for message in scene.probe.progress if message.node == NODE]
