"""A live tma_tracker: one list a stamp whatever arrives, odometry as needed, identities."""

from __future__ import annotations

import array
from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest
from sonar_tracking_msgs.msg import OperatorCommand as OperatorCommandMessage

from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    COMMANDS,
    FREQUENCY_LINES,
    ODOMETRY,
    PASSIVE_TRACKS,
)
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.graph.message_writing.command_writing import command_to_message
from sonar_tracking.graph.message_writing.line_writing import frequency_lines_to_message
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.commands import CommandKind, OperatorCommand, OwnShipLine
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import END_OF_DATA
from tests.graph.live_graph import NodeProcess, Probe, node_process, stamps
from tests.tma.passive_scene import DIRECTIONS, SECOND, one_value, scene, simulated, without_pose

NODE = "tma_tracker"
BEARINGS_INPUT = f"{NODE}: input /passive/bearing_tracks"
LINES_INPUT = f"{NODE}: input /passive/frequency_lines"
EPOCH = 1_767_225_600 * SECOND


class Tracker:
    """A live tracker and the means to feed it."""

    def __init__(self, process: NodeProcess, probe: Probe) -> None:
        self.process = process
        self.probe = probe
        self.outputs = probe.listen(PASSIVE_TRACKS)
        self.publishers = {
            topic.name: probe.publisher(topic) for topic in (BEARING_TRACKS, FREQUENCY_LINES)
        }
        self.odometry = probe.publisher(ODOMETRY)
        self._epoch = EPOCH
        self._frames = simulated(scene(DIRECTIONS, duration=20.0, epoch=EPOCH))

    def new_run(self) -> None:
        """Begin so far back that the node begins again."""
        self._epoch -= 1000 * SECOND
        self.outputs.clear()
        self.probe.diagnostics.clear()

    def bearings(self, number: int) -> BearingTracks:
        """Return the bearings of a frame of the run."""
        return self._moved(self._frames[number][0].bearings[0])

    def lines(self, number: int) -> FrequencyLines:
        """Return the lines of a frame of the run."""
        return self._moved(self._frames[number][0].lines[0])

    def own_ship(self, number: int) -> OwnShipState:
        """Return own ship at a frame of the run."""
        state = self._frames[number][1].own_ship
        return replace(state, stamp=self._stamp(number))

    def send(self, *sent: Any) -> None:
        """Publish records or messages."""
        for each in sent:
            if isinstance(each, OwnShipState):
                self.odometry.publish(array_writing.own_ship_to_message(each))
                continue
            message = each
            if isinstance(each, BearingTracks):
                message = array_writing.bearing_tracks_to_message(each)
            elif isinstance(each, FrequencyLines):
                message = frequency_lines_to_message(each)
            name = FREQUENCY_LINES.name if "Lines" in type(message).__name__ else ""
            self.publishers[name or BEARING_TRACKS.name].publish(message)

    def tick(self, stamp: int) -> None:
        """Move the clock and wait until the node has told its state."""
        heard = len(self.probe.diagnostics)
        self.probe.tick(stamp)
        self.probe.wait(lambda: len(self.probe.diagnostics) > heard, "status")

    def mark(self, frequency: float, number: int) -> None:
        """Say that a line is own ship's, from a frame on, and wait until the node has it."""
        publisher = self.probe.node.create_publisher(
            OperatorCommandMessage, COMMANDS.name, quality_of_service.ALL_COMMANDS
        )
        self.probe.wait(publisher.get_subscription_count, "commands matched")
        line = OwnShipLine(frequency, 5.0)
        kind = CommandKind.MARK_OWN_SHIP_LINE
        command = OperatorCommand(kind, "passive/tracks", stamp=self._stamp(number), line=line)
        publisher.publish(command_to_message(command))
        self.probe.wait(lambda: self.probe.finished(NODE, f"/{COMMANDS.name}"), "command received")

    def wait_lists(self, count: int) -> list[PositionTracks]:
        """Wait for so many lists and return them, one a frame."""
        self.probe.wait(
            lambda: len(self.outputs) >= count,
            f"{count} lists, there are {len(self.outputs)}; output:\n{self.process.output}",
        )
        assert stamps(self.outputs) == [self._stamp(number) for number in range(count)]
        assert self.process.is_alive
        return [position_tracks_from_message(message) for message in self.outputs]

    def _stamp(self, number: int) -> int:
        return self._epoch + number * SECOND

    def _moved(self, record: Any) -> Any:
        shift = self._epoch - EPOCH
        return replace(record, stamp=record.stamp + shift, next_stamp=record.next_stamp + shift)


@pytest.fixture(scope="module")
def tracker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tracker]:
    log = tmp_path_factory.mktemp("tracker") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "line_topics": "[passive/frequency_lines]",
        "first_id": 1 + (1 << 32),
    }
    probe = Probe()
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        tracker = Tracker(process, probe)
        topics = ("/passive/bearing_tracks", "/passive/frequency_lines", "/own_ship/odometry")
        probe.wait_matched(NODE, *topics, "/passive/tracks")
        yield tracker
    probe.close()


def test_bearings_and_lines_give_one_list_a_stamp_in_any_order_of_arrival(tracker: Tracker) -> None:
    tracker.new_run()
    for number in range(4):
        both = [tracker.bearings(number), tracker.lines(number)]
        tracker.send(*(both if number % 2 else reversed(both)))
    lists = tracker.wait_lists(4)
    assert [tracks.line_id.tolist() for tracks in lists] == [[1, 2, 3]] * 4
    assert lists[0].id.tolist() == [1 + (1 << 32)]
    assert [tracks.next_stamp for tracks in lists[:3]] == [tracks.stamp for tracks in lists[1:]]


def test_bearings_wait_for_the_lines_of_their_stamp(tracker: Tracker) -> None:
    tracker.new_run()
    tracker.send(tracker.bearings(0), tracker.lines(0), tracker.bearings(1), tracker.bearings(2))
    tracker.wait_lists(1)
    tracker.send(tracker.lines(1), tracker.lines(2))
    lists = tracker.wait_lists(3)
    assert [tracks.line_id.tolist() for tracks in lists] == [[1, 2, 3]] * 3


def test_numbers_that_are_not_finite_are_named_and_coasted_over(tracker: Tracker) -> None:
    tracker.new_run()
    for number in range(6):
        bearings, lines = tracker.bearings(number), tracker.lines(number)
        if number == 3:
            bearings = replace(bearings, measurement_variance=np.array([np.inf]))
            lines = replace(lines, frequency=one_value(lines.frequency, np.nan))
        tracker.send(bearings, lines)
    lists = tracker.wait_lists(6)
    tracker.probe.wait_sentence(f"{NODE}: data of array", "track 1", "variance inf")
    assert all(np.isfinite(tracks.state).all() for tracks in lists)
    assert len({tuple(tracks.id) for tracks in lists}) == 1


def test_messages_that_cannot_be_read_do_not_spoil_the_others(tracker: Tracker) -> None:
    tracker.new_run()
    for number in range(6):
        bearings = array_writing.bearing_tracks_to_message(tracker.bearings(number))
        lines = frequency_lines_to_message(tracker.lines(number))
        if number == 2:
            lines.frequency = array.array("d", [1.0])
        if number == 4:
            bearings.arrival_angle = array.array("d", [1.0, 2.0])
        tracker.send(bearings, lines)
    lists = tracker.wait_lists(6)
    tracker.probe.wait_sentence(LINES_INPUT, "rejected", "frequency has 1 values")
    tracker.probe.wait_sentence(BEARINGS_INPUT, "rejected", "arrival_angle has 2 values")
    assert len({tuple(tracks.id) for tracks in lists}) == 1
    assert lists[2].updated[0] == lists[2].stamp / 1e9


def test_repeated_and_older_stamps_give_no_second_list(tracker: Tracker) -> None:
    tracker.new_run()
    for number in (0, 1, 1, 0, 2):
        tracker.send(tracker.bearings(number), tracker.lines(number))
    tracker.wait_lists(3)
    tracker.probe.wait_sentence(BEARINGS_INPUT, "already received")


def test_late_odometry_is_waited_for_where_it_is_needed(tracker: Tracker) -> None:
    tracker.new_run()
    for number in range(3):
        tracker.send(without_pose(tracker.bearings(number)), replace_lines(tracker.lines(number)))
    for number in range(3):
        assert len(tracker.outputs) <= number
        tracker.send(tracker.own_ship(number))
        tracker.wait_lists(number + 1)
    assert [len(message.id) for message in tracker.outputs] == [1, 1, 1]


def test_missing_odometry_is_named_and_the_lists_come_when_the_data_begin_again(
    tracker: Tracker,
) -> None:
    tracker.new_run()
    for number in range(3):
        bearings = without_pose(tracker.bearings(number))
        tracker.send(bearings, replace_lines(tracker.lines(number)))
    first = stamp_from_time(array_writing.bearing_tracks_to_message(bearings).header.stamp)
    seconds = count()

    def is_named() -> bool:
        tracker.tick(first + next(seconds) * SECOND)
        said = tracker.probe.sentences(f"{NODE}: input /own_ship/odometry")
        return any("nothing received" in sentence for sentence in said)

    tracker.probe.wait(is_named, "odometry to be named")
    assert not tracker.outputs
    tracker.new_run()
    for number in range(3):
        tracker.send(tracker.bearings(number), tracker.lines(number))
    tracker.probe.wait(lambda: len(tracker.outputs) == 6, "six lists")
    assert [len(message.id) for message in tracker.outputs] == [0, 0, 0, 1, 1, 1]
    tracker.probe.wait_sentence(f"{NODE}: data of array", "own_ship/odometry")


def test_a_line_that_is_marked_as_own_ships_is_used_no_longer(tracker: Tracker) -> None:
    """From the stamp of the command on the lists are those of data without that line."""

    def lists(left_out: float = -1.0, marked: float | None = None) -> list[PositionTracks]:
        tracker.new_run()
        for number in range(8):
            if number == 3 and marked is not None:
                tracker.wait_lists(3)
                tracker.mark(marked, number)
            lines = tracker.lines(number)
            if number >= 3:
                lines = lines.without((abs(lines.frequency - left_out) < 2.5).tolist())
            tracker.send(tracker.bearings(number), lines)
        return tracker.wait_lists(8)

    without, marked, used = lists(left_out=300.0), lists(marked=300.0), lists()
    for found, expected in zip(marked, without, strict=True):
        assert np.array_equal(found.state, expected.state)
        assert found.line_id.tolist() == expected.line_id.tolist()
    assert not np.array_equal(used[-1].state, without[-1].state)


def test_identifiers_are_not_reused_after_a_reset(tracker: Tracker) -> None:
    tracker.new_run()
    for number in range(3):
        last = tracker.bearings(number)
        if number == 2:
            last = replace(last, next_stamp=END_OF_DATA)
        tracker.send(last, tracker.lines(number))
    before = {number for tracks in tracker.wait_lists(3) for number in tracks.id}
    tracker.new_run()
    for number in range(2):
        tracker.send(tracker.bearings(number), tracker.lines(number))
    tracks, _ = tracker.wait_lists(2)
    assert before.isdisjoint(tracks.id)


def replace_lines(lines: FrequencyLines) -> FrequencyLines:
    """Return a list without lines, at the same stamp."""
    empty: dict[str, Any] = {
        name: value[:0] for name, value in vars(lines).items() if isinstance(value, np.ndarray)
    }
    return replace(lines, **empty)
