"""A live tracker that is told something: at the stamp, behind it, and what makes no sense."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from sonar_tracking_msgs.msg import OperatorCommand as Message

from sonar_tracking.graph.catalogue.topics import COMMANDS
from sonar_tracking.graph.message_writing.command_writing import command_to_message
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.command_input import OPERATOR
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.commands import CommandKind, OperatorCommand
from tests.graph.live_graph import Probe, node_process
from tests.graph.nodes.test_bearing_tracker_node import NODE, SECOND, Tracker, estimates

LIST = "passive/bearing_tracks"
STATUS = f"{NODE}: {OPERATOR}"


class Commanded(Tracker):
    """A live tracker with somebody who commands it."""

    def begin(self) -> None:
        """Start to publish commands."""
        self._commands = self.probe.node.create_publisher(
            Message, COMMANDS.name, quality_of_service.ALL_COMMANDS
        )
        self.probe.wait(lambda: self._commands.get_subscription_count(), "commands matched")
        self._given = 0

    def tell(self, message: Message | OperatorCommand) -> None:
        """Publish a command and wait until the node says that it has it."""
        record = isinstance(message, OperatorCommand)
        self._commands.publish(command_to_message(message) if record else message)
        self._given += 1
        self.probe.wait(
            lambda: self.probe.finished(NODE, "/operator/commands") >= self._given,
            f"command {self._given} received; output of the node:\n{self.process.output}",
        )

    def running(self, count: int) -> list[list[int]]:
        """Return what goes on in each of so many lists."""
        self.probe.wait(lambda: len(self.outputs) >= count, f"{count} pictures")
        return [
            [int(n) for n, s in zip(one.id, one.status, strict=True) if s != TrackStatus.TERMINATED]
            for one in self.outputs
        ]


@pytest.fixture(scope="module")
def tracker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Commanded]:
    log = tmp_path_factory.mktemp("tracker") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "method": "ml_fusion",
        "start": "given",
        "initial_bearings_deg": "[10.0,-20.0]",
        "initial_rates_deg": "[0.0,0.0]",
        "measurement_variance_deg2": 1.0,
        "reset_after": 2.0,
    }
    probe = Probe()
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        tracker = Commanded(process, probe)
        probe.wait_matched(NODE, "/array/subspaces", "/passive/bearing_tracks", "/flow/done")
        probe.wait(lambda: tracker.publisher.get_subscription_count(), "probe matched")
        tracker.begin()
        yield tracker
    probe.close()


def test_it_waits_for_the_first_datum_at_or_after_its_stamp(tracker: Commanded) -> None:
    start = tracker.new_run()
    tracker.send(*(estimates(start, number) for number in range(2)))
    first, second = tracker.running(2)[-1]
    end = OperatorCommand(CommandKind.END_TRACK, LIST, stamp=start + 3 * SECOND + 1, id=first)
    tracker.tell(end)
    tracker.send(*(estimates(start, number) for number in range(2, 6)))
    both = [first, second]
    assert tracker.running(6) == [both, both, both, both, [second], [second]]
    assert list(tracker.outputs[4].status).count(TrackStatus.TERMINATED) == 1
    assert not any("takes effect only now" in text for text in tracker.probe.sentences(STATUS))


def test_one_that_is_late_takes_effect_before_the_next_datum_and_says_so(
    tracker: Commanded,
) -> None:
    start = tracker.new_run()
    tracker.send(*(estimates(start, number) for number in range(3)))
    first, second = tracker.running(3)[-1]
    tracker.tell(OperatorCommand(CommandKind.END_TRACK, LIST, stamp=start + SECOND, id=second))
    tracker.tell(OperatorCommand(CommandKind.START_TRACK, f"/{LIST}", arrival_angle=-0.35))
    tracker.send(estimates(start, 3))
    assert tracker.running(4)[2:] == [[first, second], [first, second + 1]]
    tracker.probe.wait_sentence(STATUS, "END_TRACK, stamped", "takes effect only now")
    tracker.probe.wait_sentence(STATUS, "START_TRACK, unstamped", "takes effect only now")


def test_what_makes_no_sense_is_refused_with_a_sentence(tracker: Commanded) -> None:
    start = tracker.new_run()
    tracker.send(*(estimates(start, number) for number in range(3)))
    known = tracker.running(3)[-1]
    later = start + 2 * SECOND + 1
    tracker.tell(OperatorCommand(CommandKind.END_TRACK, LIST, stamp=later, id=99))
    tracker.tell(OperatorCommand(CommandKind.CHOOSE_SIDE, LIST, stamp=later, id=1))
    nowhere = Message(command=1, topic=LIST, arrival_angle=float("nan"))
    nowhere.x = nowhere.y = float("nan")
    tracker.tell(nowhere)
    tracker.tell(Message(command=200, topic=LIST, id=1))
    tracker.tell(OperatorCommand(CommandKind.END_TRACK, "active/tracks", stamp=later, id=known[0]))
    tracker.send(estimates(start, 3))
    assert tracker.running(4)[-1] == known
    for words in (
        ("END_TRACK could not be done: no bearing track 99 runs",),
        ("rejected: OperatorCommand.side is 0 in CHOOSE_SIDE",),
        ("rejected: OperatorCommand does not say where in START_TRACK",),
        ("rejected: OperatorCommand.command is 200",),
    ):
        tracker.probe.wait_sentence(STATUS, *words)
    assert tracker.probe.values(STATUS)["refused"] == "4"
    assert tracker.process.is_alive
