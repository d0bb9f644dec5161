"""Operators' commands in a live graph: carried out, recorded, and in a replay the same again."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sonar_tracking_msgs.msg import OperatorCommand as Message

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.graph.catalogue.topics import ACTIVE_TRACKS, FUSED_TRACKS, REQUESTS, Topic
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.command_sender import CommandSender
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.commands import CommandKind, OperatorCommand, OwnShipLine
from sonar_tracking.records.positions import TrackHypothesis
from tests.ros_domain import ros_domain
from tests.system.command_line import RunningCommand, digests, report_of, run_command

SCENARIO = """
name: commanded
duration: 120.0
active_sonar: {ping_interval: 10.0, maximum_range: 7000.0}
own_ship: {speed: 5.0}
bearing_sensors:
  - {sensor_id: array, angle_kind: cone, frame_interval: 2.0}
targets:
  - name: freighter
    motion: {kind: kinematic, position: [-3000.0, 3000.0], course_deg: 80, speed: 6}
  - {name: ferry, motion: {kind: kinematic, position: [1000.0, 4500.0], course_deg: 200, speed: 5}}
nodes: {hpda_tracker: {}, tma_tracker: {}, track_fusion: {}}
"""
ALL_NODES = SCENARIO.splitlines()[-1]
BEACON = (5000.0, 1000.0)


class Operator:
    """Hears track lists in the same domain as a run, and sends what it is to be told."""

    def __init__(self) -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=ros_domain())
        self.node = Node("operator", context=self._context, use_global_arguments=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self.sender = CommandSender(self.node)

    def close(self) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def listen(self, topic: Topic) -> list[Any]:
        """Return a list that grows with the messages of a topic."""
        heard: list[Any] = []
        kind = message_class(topic.message_type)
        profile = quality_of_service.subscription_profile(100)
        self.node.create_subscription(kind, topic.name, heard.append, profile)
        return heard

    def wait(self, run: RunningCommand, condition: Callable[[], bool]) -> None:
        """Handle events until a condition holds while a command runs."""

        def turn() -> bool:
            # All that has come: lists come faster than one a turn, and the run does not wait.
            end = time.monotonic() + 0.05
            while time.monotonic() < end:
                self._executor.spin_once(timeout_sec=0.01)
            return condition()

        run.wait_for(turn)


@pytest.fixture
def operator() -> Iterator[Operator]:
    operator = Operator()
    yield operator
    operator.close()


def confirmed(tracks: Any) -> list[int]:
    rows = zip(tracks.id, tracks.status, strict=True)
    return sorted(int(number) for number, status in rows if status == TrackStatus.CONFIRMED)


def test_a_replay_makes_of_recorded_commands_what_the_run_made_of_them(
    tmp_path: Path, operator: Operator
) -> None:
    scene, bag, figures = tmp_path / "scene.yaml", tmp_path / "bag", tmp_path / "run.json"
    scene.write_text(SCENARIO, encoding="utf-8")
    fused = operator.listen(FUSED_TRACKS)
    requests = operator.node.create_publisher(Message, REQUESTS.name, 10)
    kinds = CommandKind
    run = RunningCommand(tmp_path, "run", scene, "--rate", 40, "--record", bag, "--json", figures)
    try:
        operator.wait(run, lambda: bool(fused and confirmed(fused[-1])))
        gone = confirmed(fused[-1])[0]
        operator.sender.send(OperatorCommand(kinds.END_TRACK, "/tracks", id=gone))
        requests.publish(Message())
        for command in (
            OperatorCommand(kinds.START_TRACK, "active/tracks", position=BEACON),
            OperatorCommand(kinds.CHOOSE_SIDE, "passive/tracks", id=1, side=TrackHypothesis.LEFT),
            OperatorCommand(kinds.MARK_OWN_SHIP_LINE, "passive/tracks", line=OwnShipLine(50.0)),
            OperatorCommand(kinds.END_TRACK, "tracks", id=99_999),
            OperatorCommand(kinds.RENAME_TRACK, "tracks", id=gone, name="rock"),
        ):
            operator.sender.send(command)
        assert run.wait() == 0, run.output
    finally:
        run.clean_up()
    live = report_of(figures)
    assert live["topics"]["/operator/commands"]["messages"] == 6
    warnings = " ".join(live["warnings"])
    assert "a request was refused: OperatorCommand.command is 0" in warnings
    assert "END_TRACK could not be done: own sensors have no track 99999" in warnings

    recording = read_bag(bag)
    assert recording.topics["/operator/commands"].role == "input"
    (stamp, *_) = [each.log_time for each in recording.messages({"/operator/commands"})]
    later = [one for one in position_tracks_of(recording, "/tracks") if one.stamp > stamp]
    assert later[0].id[later[0].status == TrackStatus.TERMINATED].tolist() == [gone]
    assert all(gone not in one.id for one in later[1:])
    active = list(position_tracks_of(recording, "/active/tracks"))
    assert any(abs(one.state[:, :2] - BEACON).max(axis=1).min() < 1.0 for one in active if len(one))

    # The run had no page; whether the replay has one makes no difference.
    page = ("--display", "page", "--no-browser", "--page-port", 0)
    figures = tmp_path / "replay.json"
    done = run_command(tmp_path, "replay", bag, "--rate", "max", *page, "--json", figures)
    assert done.returncode == 0, done.stdout
    assert done.stdout.startswith("page: http://localhost:")
    replayed = report_of(tmp_path / "replay.json")
    outputs = replayed["comparison"]
    assert {"/active/tracks", "/passive/tracks", "/tracks"} <= set(outputs)
    assert all(phrase.startswith("identical: ") for phrase in outputs.values()), outputs
    assert digests(replayed)["/operator/commands"] == digests(live)["/operator/commands"]


@pytest.mark.slow
def test_a_tracker_that_was_killed_gets_what_it_was_told_again(
    tmp_path: Path, operator: Operator
) -> None:
    scene, bag = tmp_path / "scene.yaml", tmp_path / "bag"
    longer = SCENARIO.replace("duration: 120.0", "duration: 250.0")
    scene.write_text(longer.replace(ALL_NODES, "nodes: {hpda_tracker: {}}"), encoding="utf-8")
    active = operator.listen(ACTIVE_TRACKS)
    run = RunningCommand(tmp_path, "run", scene, "--rate", 40, "--record", bag)
    try:
        operator.wait(run, lambda: bool(active and confirmed(active[-1])))
        gone = confirmed(active[-1])[0]
        operator.sender.send(OperatorCommand(CommandKind.END_TRACK, "active/tracks", id=gone))
        operator.wait(run, lambda: gone not in confirmed(active[-1]))
        run.kill_node("hpda_tracker")
        run.wait()
    finally:
        run.clean_up()
    assert "hpda_tracker was killed by SIGKILL; it was started again" in run.output
    lists = list(position_tracks_of(read_bag(bag), "/active/tracks"))
    ended = TrackStatus.TERMINATED
    told = next(n for n, one in enumerate(lists) if (one.status[one.id == gone] == ended).any())
    # The state on disk may be older than the command: it is carried out again at most.
    assert all((one.status[one.id == gone] == ended).all() for one in lists[told:])
    assert len(lists[-1]) > 0
