"""Without simulation time all trackers run at the present: half an hour of stamps from now on."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    CONTACTS,
    FREQUENCY_LINES,
    ODOMETRY,
    PASSIVE_TRACKS,
    SAMPLES,
)
from sonar_tracking.graph.message_writing.array_writing import own_ship_to_message
from sonar_tracking.graph.message_writing.contact_writing import contacts_to_message
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.graph.message_writing.sample_writing import samples_to_message
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA
from tests.graph.live_graph import NodeProcess, Probe, node_process, stamps
from tests.passive.sample_scene import Tone, blocks, element_samples

SECOND = 1_000_000_000
STEP_SECONDS = 30
STEP = STEP_SECONDS * SECOND
STEPS = 1800 // STEP_SECONDS
BLOCKS = 4
"""Of samples a step: a message stays below what passes through the usual transport at once."""
ELEMENTS = 4
TONE = Tone(300.0, 25.0, 30.0)
SPEED = 4.0
TARGET, VELOCITY = np.array([3000.0, 2000.0]), np.array([3.0, 1.0])

NODES: dict[str, dict[str, object]] = {
    "band_demodulator": {"center_frequency": 300.0, "bandwidth": 4.0, "block_snapshots": 20},
    "subspace_estimator": {
        "method": "covariance",
        "period": float(STEP_SECONDS),
        "n_subspaces": 1,
        "update_snapshots": 1,
        "covariance_snapshots": 24,
    },
    "bearing_tracker": {"method": "joint_map", "start": "automatic", "silence_time": 100.0},
    "line_tracker": {"frame_length": 4.0},
    "tma_tracker": {"line_topics": "[passive/frequency_lines]"},
    "hpda_tracker": {"initial_speed_deviation": 4.0},
}
LEAD, DEPTH = 2, 100
"""Messages a consumer may be behind its producer before the test waits, and queues: none is lost.

The line tracker waits for bearings, and publishes all lists of what has waited at once."""

EDGES = [
    ("probe", "band_demodulator", "/array/samples"),
    ("probe", "line_tracker", "/array/samples"),
    ("probe", "hpda_tracker", "/active/contacts"),
    ("band_demodulator", "subspace_estimator", "/array/snapshots"),
    ("subspace_estimator", "bearing_tracker", "/array/subspaces"),
    ("bearing_tracker", "line_tracker", "/passive/bearing_tracks"),
    ("bearing_tracker", "tma_tracker", "/passive/bearing_tracks"),
    ("line_tracker", "tma_tracker", "/passive/frequency_lines"),
]


class HalfHour:
    """Six live nodes without ``/clock``, and what feeds them half an hour of data."""

    def __init__(self, probe: Probe, processes: dict[str, NodeProcess]) -> None:
        self.probe = probe
        self.processes = processes
        outputs = (BEARING_TRACKS, FREQUENCY_LINES, PASSIVE_TRACKS, ACTIVE_TRACKS)
        self.heard = {topic.name: probe.listen(topic) for topic in outputs}
        self.publishers = {t.name: probe.publisher(t) for t in (SAMPLES, CONTACTS, ODOMETRY)}
        # Of the same phase each time: each step has the same noise, which is no source then.
        self.start = time.time_ns() // STEP * STEP + 7 * SECOND
        self._samples = [samples_to_message(block) for block in _blocks()]
        self._counts: dict[tuple[str, str], int] = {}

    def is_matched(self) -> bool:
        """Return whether every node hears what the probe publishes."""
        listeners = {SAMPLES.name: 2, CONTACTS.name: 1, ODOMETRY.name: 2}
        counts = {
            name: publisher.get_subscription_count() for name, publisher in self.publishers.items()
        }
        return counts == listeners

    def are_heard(self) -> bool:
        """Return whether every node knows all that read it: what it sends before that is lost."""
        readers = Counter((producer, topic) for producer, _, topic in EDGES if producer != "probe")
        for producer, topic in readers:
            readers[producer, topic] += topic.lstrip("/") in self.heard
        return all(
            int(self.probe.matched(producer).get(topic, 0)) == count
            for (producer, topic), count in readers.items()
        )

    def feed(self) -> None:
        """Publish everything, no faster than the nodes take it."""
        self._publish_own_ship(0)
        for number in range(STEPS):
            self._publish_own_ship(number + 1)
            last = number == STEPS - 1
            following = END_OF_DATA if last else self.start + (number + 1) * STEP
            for index, samples in enumerate(self._samples, start=1):
                begin = self.start + number * STEP + (index - 1) * STEP // BLOCKS
                ends = last and index == BLOCKS
                samples.header.stamp = time_from_stamp(begin)
                samples.next_stamp = time_from_stamp(
                    END_OF_DATA if ends else begin + STEP // BLOCKS
                )
                self.publishers[SAMPLES.name].publish(samples)
                self._counts["probe", "/array/samples"] = BLOCKS * number + index
                self._wait()
            ping = replace(_ping(number), stamp=self.start + number * STEP, next_stamp=following)
            self.publishers[CONTACTS.name].publish(contacts_to_message(ping))
            self._counts["probe", "/active/contacts"] = number + 1
            self._wait()
        self._publish_own_ship(STEPS + 1)  # the last bearings belong to the end of their period

    def _publish_own_ship(self, number: int) -> None:
        position = (SPEED * number * STEP_SECONDS, 0.0)
        state = OwnShipState(self.start + number * STEP, position, 0.0, (SPEED, 0.0), 0.0)
        self.publishers[ODOMETRY.name].publish(own_ship_to_message(state))

    def _wait(self) -> None:
        """Wait for the slowest node: the usual transport holds four blocks of samples, no more."""
        self.probe.wait(
            lambda: self._behind() <= LEAD,
            lambda: f"all but {LEAD} of what was published to be finished: {self._counts}",
        )

    def _behind(self) -> int:
        """Return the largest number of messages any consumer has not finished."""
        for each in self.probe.progress:
            self._counts[each.node, each.topic] = each.count
        self.probe.progress.clear()
        return max(
            self._counts.get((producer, topic), 0) - self._counts.get((consumer, topic), 0)
            for producer, consumer, topic in EDGES
        )


def _blocks() -> list[ArraySamples]:
    """Return the samples of a step; the tone has whole periods in it."""
    data = element_samples([TONE], float(STEP_SECONDS))
    return [
        replace(
            block,
            data=block.data[:, :ELEMENTS],
            element_positions=block.element_positions[:ELEMENTS],
        )
        for block in blocks(data, block_samples=len(data) // BLOCKS)
    ]


def _ping(number: int) -> Contacts:
    """One target among clutter, from a sensor that does not know where it is."""
    generator = np.random.default_rng(number)
    seconds = number * STEP_SECONDS
    separation = TARGET + seconds * VELOCITY - (SPEED * seconds, 0.0)
    clutter = 5000.0 * np.sqrt(generator.random(3)), 2.0 * np.pi * generator.random(3)
    return Contacts(
        stamp=0,
        range=np.append(clutter[0], np.hypot(*separation)),
        azimuth=np.append(clutter[1], np.arctan2(separation[1], separation[0])),
        amplitude=np.append(5.0 + generator.exponential(size=3), 15.0),
        range_standard_deviation=20.0,
        azimuth_standard_deviation=0.01,
        sensor_position=(math.nan, math.nan),
        sensor_velocity=(math.nan, math.nan),
        detection_threshold=5.0,
        maximum_range=5000.0,
    )


@pytest.fixture(scope="module")
def half_hour(tmp_path_factory: pytest.TempPathFactory) -> Iterator[HalfHour]:
    logs = tmp_path_factory.mktemp("half_hour")
    probe = Probe()
    with ExitStack() as running:
        processes = {
            name: running.enter_context(
                node_process(
                    f"sonar_tracking.graph.nodes.{name}",
                    logs / name,
                    flow_depth=DEPTH,
                    **parameters,
                )
            )
            for name, parameters in NODES.items()
        }
        half_hour = HalfHour(probe, processes)
        for _, consumer, topic in EDGES:
            probe.wait_matched(consumer, topic, "/flow/done")
        probe.wait(half_hour.are_heard, "every node matched with all that read it")
        for name in ("tma_tracker", "hpda_tracker"):
            probe.wait_matched(name, "/own_ship/odometry")
        probe.wait(half_hour.is_matched, "every node matched with the probe")
        half_hour.feed()
        passive = half_hour.heard[PASSIVE_TRACKS.name]
        end = time_from_stamp(END_OF_DATA)
        probe.wait(
            lambda: (
                len(half_hour.heard[ACTIVE_TRACKS.name]) == STEPS
                and passive
                and passive[-1].next_stamp == end
            ),
            "the end of the data",
        )
        yield half_hour
    probe.close()


def test_every_ping_of_the_half_hour_gives_its_picture(half_hour: HalfHour) -> None:
    pictures = half_hour.heard[ACTIVE_TRACKS.name]
    assert stamps(pictures) == [half_hour.start + number * STEP for number in range(STEPS)]
    last = position_tracks_from_message(pictures[-1])
    (row,) = np.flatnonzero(last.status == TrackStatus.CONFIRMED)
    expected = TARGET + (STEPS - 1) * STEP_SECONDS * VELOCITY
    assert last.state[row, :2] == pytest.approx(expected, abs=80.0)
    assert last.initiated[row] * SECOND >= half_hour.start - SECOND


def test_bearings_lines_and_positions_last_the_half_hour(half_hour: HalfHour) -> None:
    """At whole periods of stamp time, whatever the present is; not worse at the end."""
    bearings = half_hour.heard[BEARING_TRACKS.name]
    assert all(stamp % STEP == 0 for stamp in stamps(bearings))
    assert len(bearings) >= STEPS - 3
    for picture in bearings[10:-1]:
        (row,) = np.flatnonzero(np.array(picture.status) == TrackStatus.CONFIRMED)
        assert math.degrees(picture.arrival_angle[row]) == pytest.approx(TONE.angle_deg, abs=1.0)
    lines = half_hour.heard[FREQUENCY_LINES.name][100:-2]
    assert lines and all(
        [round(frequency) for frequency in message.frequency] == [TONE.frequency]
        for message in lines
    )
    pictures = half_hour.heard[PASSIVE_TRACKS.name]
    assert stamps(pictures) == stamps(bearings)
    assert all(
        half_hour.start - STEP <= stamp <= half_hour.start + STEPS * STEP for stamp in stamps(lines)
    )
    assert len(pictures[-2].id) > 0


def test_nothing_of_the_half_hour_was_an_error(half_hour: HalfHour) -> None:
    told = [status for message in half_hour.probe.diagnostics for status in message.status]
    assert not [status.message for status in told if status.level == DiagnosticStatus.ERROR]
    assert not [status.message for status in told if "/clock" in status.message]
    for process in half_hour.processes.values():
        assert process.is_alive
        assert "rejected" not in process.output and "Traceback" not in process.output
