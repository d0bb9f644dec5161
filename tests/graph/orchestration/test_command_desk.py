"""Requests get stamps behind all data that are out; the data wait until all trackers have them."""

from __future__ import annotations

import struct

import pytest
from sonar_tracking_msgs.msg import OperatorCommand as Message

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.graph.message_writing.command_writing import command_to_message
from sonar_tracking.graph.orchestration.command_desk import MOST_WAITING, CommandDesk
from sonar_tracking.graph.orchestration.finished_stamps import FinishedStamps
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.stall_watch import LOST_SECONDS
from sonar_tracking.records.commands import CommandKind, OperatorCommand

COMMANDS = "/ship/operator/commands"
LISTS = {"/ship/passive/bearing_tracks": "passive/bearing_tracks", "/ship/tracks": "tracks"}
END = OperatorCommand(CommandKind.END_TRACK, "/ship/tracks", id=3)
REACHED = 1_767_225_600_000_000_000


class Run:
    """A run with two trackers, in place of the ROS side."""

    def __init__(self) -> None:
        consumers = {COMMANDS: ("bearings", "fusion")}
        self.ledger = FlowLedger(consumers, {COMMANDS: "orchestration"})
        self.finished = FinishedStamps()
        self.notices: dict[str, str] = {}
        self.sent: list[bytes] = []
        self.commands: list[OperatorCommand] = []
        self.desk = CommandDesk(
            COMMANDS, LISTS, consumers[COMMANDS], self.ledger, self, self.note, self.bytes_of
        )

    def publish(self, topic: str, data: bytes) -> None:
        assert topic == COMMANDS
        self.sent.append(data)

    def note(self, topic: str, data: bytes, wall: float) -> None:
        assert (topic, data) == (COMMANDS, self.sent[-1])

    def bytes_of(self, command: OperatorCommand) -> bytes:
        self.commands.append(command)
        return b"\0\1\0\0" + struct.pack("<iI", *divmod(command.stamp, 10**9))

    def ask(self, command: OperatorCommand) -> None:
        self.desk.take(command_to_message(command))

    def receive(self, node: str, count: int) -> None:
        self.ledger.finished(node, COMMANDS, count)
        self.finished.finished(node, COMMANDS, head_stamp(self.sent[count - 1]))


def test_the_clock_stands_until_every_tracker_has_the_command() -> None:
    run = Run()
    assert not run.desk.holds(REACHED, 0.0)
    run.ask(END)
    assert not run.desk.holds(None, 0.0) and not run.sent  # nothing has begun
    assert run.desk.holds(REACHED, 0.0)
    run.receive("bearings", 1)
    assert run.desk.holds(REACHED, 0.1)
    run.receive("fusion", 1)
    assert not run.desk.holds(REACHED, 0.2)
    assert run.desk.given == len(run.sent) == 1


def test_stamps_lie_behind_everything_that_is_out_and_rise() -> None:
    run = Run()
    for _ in range(3):
        run.ask(END)
    assert run.desk.holds(REACHED, 0.0)
    assert [one.stamp - REACHED for one in run.commands] == [1, 2, 3]
    run.ask(END)
    assert run.desk.holds(REACHED, 0.0)
    assert run.commands[-1].stamp == REACHED + 4
    # The list has the name that it has in a graph without a namespace.
    assert {one.topic for one in run.commands} == {"tracks"}


def test_who_has_died_is_not_waited_for_but_who_was_started_again_is() -> None:
    run = Run()
    run.ask(END)
    run.desk.holds(REACHED, 0.0)
    run.receive("bearings", 1)
    run.ledger.leave("fusion")
    assert not run.desk.holds(REACHED, 0.1)
    run.ledger.rejoin("fusion")
    run.ask(END)
    assert run.desk.holds(REACHED, 0.2)
    run.receive("bearings", 2)
    assert run.desk.holds(REACHED, 0.3)
    run.receive("fusion", 1)  # it is told all commands of the run
    assert run.desk.holds(REACHED, 0.4)
    run.receive("fusion", 2)
    assert not run.desk.holds(REACHED, 0.5)


def test_a_tracker_that_never_answers_does_not_stop_the_run_for_ever() -> None:
    run = Run()
    run.ask(END)
    assert run.desk.holds(REACHED, 0.0) and run.desk.holds(REACHED, 0.9 * LOST_SECONDS)
    assert not run.desk.holds(REACHED, LOST_SECONDS)


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (Message(), "command is 0"),
        (Message(command=99, topic="tracks"), "command is 99"),
        (Message(command=2, topic="tracks"), "id is 0 in END_TRACK"),
        (Message(command=2, topic="active/tracks", id=1), "the track lists are passive/bearing"),
        (Message(command=4, topic="tracks", id=1, side=1), "CHOOSE_SIDE cannot be done to tracks"),
        (Message(command=1, topic="/passive/bearing_tracks", arrival_angle=float("nan")), "where"),
        (Message(command=3, topic="tracks", id=4, other_id=4), "give two tracks"),
        (Message(command=5, topic="tracks", id=4, name=" "), "give a name"),
        (Message(command=5, topic="tracks", id=4, name="x" * 10_000), "longer than"),
        (Message(command=2, topic="tracks", id=1, side=77), "side is 77"),
    ],
)
def test_what_cannot_be_done_never_gets_into_the_graph(request_: Message, words: str) -> None:
    run = Run()
    if words == "where":
        request_.x = request_.y = float("nan")
    run.desk.take(request_)
    assert not run.desk.holds(REACHED, 0.0) and not run.sent
    (sentence,) = run.notices.values()
    assert words in sentence and sentence.startswith("a request was refused: ")


def test_a_flood_of_requests_is_cut_off() -> None:
    run = Run()
    for _ in range(2 * MOST_WAITING):
        run.ask(END)
    run.desk.holds(REACHED, 0.0)
    assert len(run.sent) == MOST_WAITING
    assert "send fewer" in run.notices[f"{COMMANDS}: refused"]
