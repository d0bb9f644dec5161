"""What is shown of a run: one tree of frames, recorded for people, and never in the way."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.scene.rigid_pose import RigidPose
from tests.system.command_line import RunningCommand, digests, report_of, run_command
from tests.system.conftest import RecordedRun
from tests.system.shown_runs import shown_run

SHOWN = {"/tf", "/tf_static", "/diagnostics"}
BASE = "own_ship/base_link"


def decoded(bag: Bag, topic: str) -> Iterator[Any]:
    """Yield the messages of a topic, read without ROS."""
    kind = bag.topics[topic].type_name
    store = installed_typestore(kind)
    for message in bag.messages([topic]):
        yield store.deserialize_cdr(message.data, kind)


def pose_of(position: Any, turn: Any) -> RigidPose:
    return RigidPose((position.x, position.y, position.z), (turn.x, turn.y, turn.z, turn.w))


class Tree:
    """The frames of a bag, as a display knows them at the end."""

    def __init__(self, bag: Bag) -> None:
        self.moving: dict[tuple[str, int], tuple[str, RigidPose]] = {}
        self.fixed: dict[str, tuple[str, RigidPose]] = {}
        for topic in ("/tf", "/tf_static"):
            for message in decoded(bag, topic) if topic in bag.topics else ():
                for each in message.transforms:
                    moved = pose_of(each.transform.translation, each.transform.rotation)
                    found = (each.header.frame_id, moved)
                    if topic == "/tf_static":
                        self.fixed[each.child_frame_id] = found
                    else:
                        stamp = stamp_from_time(each.header.stamp)
                        self.moving[each.child_frame_id, stamp] = found

    def in_map(self, frame: str, stamp: int) -> RigidPose:
        """Return the pose of a frame in ``map``, the root of everything."""
        if frame == "map":
            return RigidPose()
        parent, pose = self.fixed.get(frame) or self.moving[frame, stamp]
        return pose.placed_in(self.in_map(parent, stamp))


@pytest.fixture(scope="session")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Record a scenario with what is shown of it, once; return the folder of bag and report."""
    return partial(shown_run, tmp_path_factory)


@pytest.mark.parametrize(
    ("scenario", "topic", "frame"),
    [
        ("tma", "/passive/bearing_tracks", "own_ship/array"),
        ("active", "/active/contacts", "own_ship/sonar"),
    ],
)
def test_frames_put_a_sensor_where_the_tracker_has_it(
    shown: Callable[[str], Path], scenario: str, topic: str, frame: str
) -> None:
    bag = read_bag(shown(scenario) / "bag")
    tree = Tree(bag)
    assert tree.fixed[frame][0] == BASE
    compared = 0
    for odometry in decoded(bag, "/own_ship/odometry"):
        there = tree.in_map(BASE, stamp_from_time(odometry.header.stamp))
        pose = odometry.pose.pose
        told = pose_of(pose.position, pose.orientation)
        assert there.position == told.position
        assert there.angle_to(told) < 1e-9
    for message in decoded(bag, topic):
        stamp = stamp_from_time(message.header.stamp)
        if (BASE, stamp) in tree.moving:  # between two poses of own ship a display interpolates
            there = tree.in_map(frame, stamp)
            told = pose_of(message.sensor_pose.position, message.sensor_pose.orientation)
            assert there.position == pytest.approx(told.position, abs=1.0)
            assert there.angle_to(told) < 0.02
            compared += 1
    assert compared > 10


def test_what_is_shown_is_recorded_but_neither_compared_nor_played(
    shown: Callable[[str], Path], tmp_path: Path
) -> None:
    folder = shown("active")
    bag = folder / "bag"
    roles = {name: topic.role for name, topic in read_bag(bag).topics.items()}
    pictures = {*SHOWN, "/active/markers"}
    assert pictures <= {name for name, role in roles.items() if role == "display"}
    assert not pictures & set(report_of(folder / "run.json")["topics"])
    counts = {name: topic.message_count for name, topic in read_bag(bag).topics.items()}
    assert counts["/tf"] == counts["/own_ship/odometry"]
    assert counts["/active/markers"] == counts["/active/tracks"]
    # Nothing is said before the data: a player would wait there for decades.
    times = [message.log_time for message in read_bag(bag).messages()]
    assert times[-1] - times[0] <= 200e9

    arguments = ("--rate", "max", "--no-display", "--json", tmp_path / "replay.json")
    again = tmp_path / "again"
    done = run_command(tmp_path, "replay", bag, *arguments, "--record", again, pictures=True)
    assert done.returncode == 0, done.stdout
    replayed, live = report_of(tmp_path / "replay.json"), report_of(folder / "run.json")
    assert set(replayed["comparison"]) == {"/active/tracks", "/active/threshold"}
    assert digests(replayed) == {name: digests(live)[name] for name in digests(replayed)}
    assert {name: topic.role for name, topic in read_bag(again).topics.items()} == roles


def test_pictures_can_be_left_out(active_run: RecordedRun) -> None:
    roles = {name: topic.role for name, topic in read_bag(active_run.bag).topics.items()}
    assert "display" not in roles.values()
    assert "/active/tracks" in roles


def test_a_run_goes_on_without_what_shows_it(tmp_path: Path) -> None:
    report = tmp_path / "report.json"
    paced = ("--duration", "300", "--rate", "60")
    arguments = ("run", "active", *paced, "--no-display", "--json", report)
    command = RunningCommand(tmp_path, *arguments, pictures=True)
    try:
        command.wait_for_text("data flow")
        command.kill_node("scene_publisher")
        assert command.wait() == 0, command.output
    finally:
        command.clean_up()
    assert "warning: scene_publisher was killed by SIGKILL; the run goes on" in command.output
    assert report_of(report)["failures"] == []
