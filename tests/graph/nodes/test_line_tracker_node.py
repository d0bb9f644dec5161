"""A live line_tracker: one list a frame whatever arrives, bad samples and bearings named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, FREQUENCY_LINES, LOFAR, SAMPLES
from sonar_tracking.graph.message_writing.array_writing import bearing_tracks_to_message
from sonar_tracking.graph.message_writing.sample_writing import samples_to_message
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.message_reading.sample_reading import lofar_rows_from_message
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS
from tests.graph.live_graph import NodeProcess, Probe, node_process, stamps
from tests.passive.sample_scene import EPOCH, Tone, bearings, blocks, element_samples

NODE = "line_tracker"
SAMPLES_INPUT = f"{NODE}: input /array/samples"
BEARINGS_INPUT = f"{NODE}: input /passive/bearing_tracks"
ANGLE_DEG, FREQUENCY, LEVEL_DB = 20.0, 150.0, 30.0
HOP = NANOSECONDS // 2
"""Frames of 1 s overlap by half."""

SCENE = element_samples([Tone(FREQUENCY, ANGLE_DEG, LEVEL_DB)], 5.0)
"""Its 20 blocks complete the frames centred 0.5, 1 ... 4.5 s after the start."""

FRAMES = list(range(1, 10))


class Tracker:
    """A live tracker and the means to feed it."""

    def __init__(self, process: NodeProcess, probe: Probe) -> None:
        self.process = process
        self.probe = probe
        self.lines = probe.listen(FREQUENCY_LINES)
        self.rows = probe.listen(LOFAR)
        self.sent = {SAMPLES.name: 0, BEARING_TRACKS.name: 0}
        self._publishers = {
            topic.name: probe.publisher(topic) for topic in (SAMPLES, BEARING_TRACKS)
        }
        self.start = EPOCH

    def new_run(self) -> list[ArraySamples]:
        """Begin so far back that the node begins again; return the blocks of the scene."""
        self.start -= 1000 * NANOSECONDS
        self.lines.clear()
        self.rows.clear()
        self.probe.diagnostics.clear()
        return blocks(SCENE, stamp=self.start)

    def send(self, *sent: Any) -> None:
        """Publish blocks, each beside the bearing at its begin, or messages as they are."""
        for each in sent:
            if isinstance(each, ArraySamples):
                picture = replace(bearings([ANGLE_DEG], each.stamp), next_stamp=each.next_stamp)
                self.publish(BEARING_TRACKS.name, bearing_tracks_to_message(picture))
                self.publish(SAMPLES.name, samples_to_message(each))
            else:
                self.publish(SAMPLES.name, each)

    def publish(self, name: str, message: Any) -> None:
        """Publish a message and wait until the node has finished it."""
        self._publishers[name].publish(message)
        self.sent[name] += 1
        self.probe.wait(
            lambda: self.probe.finished(NODE, f"/{name}") >= self.sent[name],
            f"message {self.sent[name]} of {name}; output of the node:\n{self.process.output}",
        )

    def wait_lists(self, count: int) -> None:
        """Wait for so many lists, one a frame in order, each of which passes on the next stamp."""
        self.probe.wait_for_count(self.lines.__len__, count, "lists")
        expected = [self.start + frame * HOP for frame in range(1, count + 1)]
        assert stamps(self.lines) == expected
        following = [stamp_from_time(message.next_stamp) for message in self.lines]
        assert following[:-1] == expected[1:]
        assert self.process.is_alive

    def rows_of_frames(self) -> list[int]:
        """Return the frames a row of the picture was sent for."""
        return [(stamp - self.start) // HOP for stamp in stamps(self.rows)]

    def assert_rejected(self, sent: Sequence[Any], bad: int, *parts: str) -> None:
        """Check that block ``bad`` is named, and only the frames that need it have no row."""
        self.send(*sent)
        self.probe.wait_sentence(SAMPLES_INPUT, *parts)
        self.wait_lists(10)
        begin = bad // 2  # two blocks a hop, and every block is in two frames
        lost = [frame for frame in FRAMES if frame in (begin, begin + 1)]
        self.probe.wait_for_count(self.rows.__len__, len(FRAMES) - len(lost), "rows")
        assert self.rows_of_frames() == [frame for frame in FRAMES if frame not in lost]


@pytest.fixture(scope="module")
def tracker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tracker]:
    log = tmp_path_factory.mktemp("line_tracker") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "frame_length": 1.0,
        "maximum_frequency": 400.0,
    }
    probe = Probe()
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        tracker = Tracker(process, probe)
        topics = ("/array/samples", "/passive/bearing_tracks", "/passive/frequency_lines")
        probe.wait_matched(NODE, *topics, "/array/lofar", "/flow/done")
        yield tracker
    probe.close()


def test_a_tone_on_a_tracked_bearing_becomes_its_line(tracker: Tracker) -> None:
    tracker.send(*tracker.new_run())
    tracker.wait_lists(10)
    assert stamp_from_time(tracker.lines[-1].next_stamp) == END_OF_DATA
    heard = tracker.lines[8]
    assert list(heard.track_id) == [1]
    assert heard.frequency[0] == pytest.approx(FREQUENCY, abs=4.0 * heard.standard_deviation[0])
    assert heard.arrival_angle[0] == pytest.approx(np.radians(ANGLE_DEG))
    assert {each for message in tracker.lines for each in message.line_id} == set(heard.line_id)
    assert tracker.rows_of_frames() == FRAMES
    rows = lofar_rows_from_message(tracker.rows[-1])
    loudest = rows.first_frequency + rows.bin_width * np.argmax(rows.level_db[0])
    assert loudest == pytest.approx(FREQUENCY, abs=rows.bin_width)


def test_samples_wait_for_the_bearings_at_their_begin(tracker: Tracker) -> None:
    """The list does not depend on which of the two arrives first."""
    for block in tracker.new_run():
        tracker.publish(SAMPLES.name, samples_to_message(block))
        picture = replace(bearings([ANGLE_DEG], block.stamp), next_stamp=block.next_stamp)
        tracker.publish(BEARING_TRACKS.name, bearing_tracks_to_message(picture))
    tracker.wait_lists(10)
    assert list(tracker.lines[8].track_id) == [1]


@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_samples_that_are_not_finite(tracker: Tracker, value: float) -> None:
    sent: list[Any] = tracker.new_run()
    data = sent[8].data.copy()
    data[7, 2] = value
    sent[8] = replace(sent[8], data=data)
    tracker.assert_rejected(sent, 8, "Element 2 of sample 7", "not a finite number")


def test_a_wrong_number_of_values(tracker: Tracker) -> None:
    sent: list[Any] = tracker.new_run()
    message = samples_to_message(sent[8])
    message.data = message.data[:-1]
    sent[8] = message
    tracker.assert_rejected(sent, 8, "ArraySamples.data has 3999 values", "need 4000")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"sample_rate": 900.0}, "rejected: sample_rate is 900 Hz"),
        ({"sample_rate": 1001.0}, "rejected: sample_rate changed from 1000 to 1001"),
        ({"sound_speed": -1.0}, "rejected: sound_speed is -1"),
        ({"sensor": Sensor("towed")}, "comes from sensor 'towed'"),
    ],
)
def test_another_array_or_rate(tracker: Tracker, changes: dict[str, Any], sentence: str) -> None:
    sent: list[Any] = tracker.new_run()
    sent[8] = replace(sent[8], **changes)
    tracker.assert_rejected(sent, 8, sentence)


def test_the_end_of_the_data_is_passed_on_even_with_a_block_that_cannot_be_used(
    tracker: Tracker,
) -> None:
    sent = tracker.new_run()
    tracker.send(*sent[:-1], replace(sent[-1], data=np.full_like(sent[-1].data, np.nan)))
    tracker.probe.wait_sentence(SAMPLES_INPUT, "rejected", "not a finite number")
    tracker.probe.wait(
        lambda: tracker.lines and stamp_from_time(tracker.lines[-1].next_stamp) == END_OF_DATA,
        "the end of the data",
    )
    assert list(tracker.lines[-1].line_id) == []


def test_bearings_that_cannot_be_used_leave_the_ones_before_in_force(tracker: Tracker) -> None:
    sent = tracker.new_run()
    tracker.send(*sent[:8])
    short = bearing_tracks_to_message(bearings([ANGLE_DEG], sent[8].stamp))
    short.arrival_angle = []
    short.covariance = short.covariance[:-1]
    tracker.publish(BEARING_TRACKS.name, short)
    tracker.publish(SAMPLES.name, samples_to_message(sent[8]))
    tracker.send(*sent[9:])
    tracker.probe.wait_sentence(BEARINGS_INPUT, "rejected", "covariance has 3 values")
    tracker.wait_lists(10)
    assert tracker.rows_of_frames() == FRAMES
    assert list(tracker.lines[8].track_id) == [1]


def test_a_silent_element_is_named_and_left_out(tracker: Tracker) -> None:
    for block in tracker.new_run():
        data = block.data.copy()
        data[:, 4] = 0.0
        tracker.send(replace(block, data=data))
    tracker.probe.wait_sentence(f"{NODE}: element 4", "Element 4 is silent", "check its cable")
    tracker.wait_lists(10)
    assert list(tracker.lines[8].track_id) == [1]


def test_a_new_run_knows_no_lines_of_the_one_before(tracker: Tracker) -> None:
    tracker.send(*tracker.new_run())
    tracker.wait_lists(10)
    before = set(tracker.lines[8].line_id)
    tracker.send(*tracker.new_run())
    tracker.wait_lists(10)
    assert list(tracker.lines[0].line_id) == [], "a line is confirmed by three frames"
    assert not before & set(tracker.lines[8].line_id), "identifiers are never used again"


def test_every_message_was_counted(tracker: Tracker) -> None:
    """Last: the ledger of the time master must balance, rejected messages included."""
    announced = [p.count for p in tracker.probe.progress if p.topic == "/passive/frequency_lines"]
    assert announced == sorted(set(announced))
    assert tracker.process.stop() == 0
    assert "Traceback" not in tracker.process.output
