"""A live tracker: exactly one picture an estimate, usable or not, and identifiers never reused."""

from __future__ import annotations

import array
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.geometry import line_array
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, SUBSPACES
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.records.bearings import SubspaceEstimates, TrackStatus
from sonar_tracking.records.time import END_OF_DATA
from tests.graph.live_graph import NodeProcess, Probe, node_process, stamps

NODE = "bearing_tracker"
INPUT = f"{NODE}: input /array/subspaces"
SECOND = 1_000_000_000
NEWEST_RUN = 1_767_225_600 * SECOND
ANGLES_DEG = (10.0, -20.0)
N_ELEMENTS = 8


def estimates(start: int, number: int) -> SubspaceEstimates:
    """Exact subspaces of two sources at rest, at sample time ``number`` of a run."""
    positions = line_array(N_ELEMENTS, 0.5)
    phases = 2.0 * np.pi * positions[:, :1] * np.sin(np.radians(ANGLES_DEG))
    steering = np.exp(1j * phases)
    stamp = start + number * SECOND
    return SubspaceEstimates(
        stamp=stamp,
        method="covariance",
        basis=np.stack([steering] * 3),
        time_offsets=np.array([-0.1, 0.0, 0.1]),
        element_positions=positions,
        sample_period=0.005,
        center_frequency=1500.0,
        bandwidth=10.0,
        sound_speed=1500.0,
        effective_snapshots=39.0,
        next_stamp=stamp + SECOND,
    )


class Tracker:
    """A live tracker and the means to feed it."""

    def __init__(self, process: NodeProcess, probe: Probe) -> None:
        self.process = process
        self.probe = probe
        self.outputs = probe.listen(BEARING_TRACKS)
        self.publisher = probe.publisher(SUBSPACES)
        self.sent = 0
        self._run = NEWEST_RUN

    def new_run(self) -> int:
        """Return the start of a run that lies so far back that the node begins again."""
        self._run -= 1000 * SECOND
        self.outputs.clear()
        self.probe.diagnostics.clear()
        return self._run

    def send(self, *sent: Any) -> None:
        """Publish estimates (or messages) and wait until the node has finished them."""
        for each in sent:
            record = isinstance(each, SubspaceEstimates)
            self.publisher.publish(array_writing.subspaces_to_message(each) if record else each)
            self.sent += 1
            self.probe.wait(
                lambda: self.probe.finished(NODE, "/array/subspaces") >= self.sent,
                f"message {self.sent} finished; output of the node:\n{self.process.output}",
            )

    def assert_rejected(self, bad: Any, start: int, *parts: str) -> None:
        """Check that a bad estimate is named and gives the predicted picture."""
        self.send(*(estimates(start, number) for number in range(3)), bad)
        self.send(*(estimates(start, number) for number in range(4, 6)))
        self.probe.wait_sentence(INPUT, "rejected", *parts)
        self.assert_pictures(start, range(6))
        assert list(self.outputs[3].status) == [TrackStatus.COASTED] * 2
        assert list(self.outputs[5].status) == [TrackStatus.CONFIRMED] * 2

    def assert_pictures(self, start: int, numbers: Any) -> None:
        """Check one output a sample time, with both tracks where the sources are."""
        expected = [start + number * SECOND for number in numbers]
        self.probe.wait(lambda: len(self.outputs) >= len(expected), "pictures")
        assert stamps(self.outputs) == expected
        for picture in self.outputs:
            np.testing.assert_allclose(np.degrees(picture.arrival_angle), ANGLES_DEG, atol=0.2)
        assert self.process.is_alive


@pytest.fixture(scope="module")
def tracker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tracker]:
    log = tmp_path_factory.mktemp("tracker") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "method": "ml_fusion",
        "start": "given",
        "initial_bearings_deg": "[10.0,-20.0]",
        "initial_rates_deg": "[0.0,0.0]",
        "measurement_variance_deg2": 1.0,
        "reset_after": 2.0,
        "first_id": 1 + (1 << 32),
    }
    probe = Probe()
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        tracker = Tracker(process, probe)
        topics = ("/array/subspaces", "/passive/bearing_tracks", "/clock", "/flow/done")
        probe.wait_matched(NODE, *topics)
        probe.wait(lambda: tracker.publisher.get_subscription_count(), "probe matched")
        yield tracker
    probe.close()


def test_good_estimates_give_one_picture_each(tracker: Tracker) -> None:
    start = tracker.new_run()
    tracker.send(*(estimates(start, number) for number in range(4)))
    tracker.assert_pictures(start, range(4))
    assert list(tracker.outputs[-1].id) == [1 + (1 << 32), 2 + (1 << 32)]


def test_values_that_are_not_finite(tracker: Tracker) -> None:
    start = tracker.new_run()
    bad = estimates(start, 3)
    bad.basis[1, 2, 0] = np.nan
    tracker.assert_rejected(bad, start, "not finite")


def test_columns_of_unequal_length(tracker: Tracker) -> None:
    start = tracker.new_run()
    bad = array_writing.subspaces_to_message(estimates(start, 3))
    bad.time_offsets = array.array("d", [0.0])
    tracker.assert_rejected(bad, start, "time_offsets has 1 values, but n_subspaces is 3")


def test_no_subspaces_at_a_sample_time(tracker: Tracker) -> None:
    start = tracker.new_run()
    empty = replace(
        estimates(start, 2),
        basis=np.empty((0, N_ELEMENTS, 2), complex),
        time_offsets=np.empty(0),
    )
    tracker.send(estimates(start, 0), estimates(start, 1), empty, estimates(start, 3))
    tracker.probe.wait_sentence(f"{NODE}: subspace", "predicted only")
    tracker.assert_pictures(start, range(4))
    assert list(tracker.outputs[2].status) == [TrackStatus.COASTED] * 2


def test_a_bad_first_estimate_gives_the_empty_picture(tracker: Tracker) -> None:
    start = tracker.new_run()
    bad = estimates(start, 0)
    bad.basis[0, 0, 0] = np.inf
    tracker.send(bad, *(estimates(start, number) for number in range(1, 4)))
    tracker.probe.wait(lambda: len(tracker.outputs) == 4, "pictures")
    assert stamps(tracker.outputs) == [start + number * SECOND for number in range(4)]
    assert [len(picture.id) for picture in tracker.outputs] == [0, 2, 2, 2]


def test_a_duplicate_gives_no_second_picture(tracker: Tracker) -> None:
    start = tracker.new_run()
    tracker.send(*(estimates(start, number) for number in (0, 1, 1, 0, 2)))
    tracker.probe.wait_sentence(INPUT, "already received")
    tracker.assert_pictures(start, range(3))


def test_identifiers_are_not_reused_after_a_reset(tracker: Tracker) -> None:
    start = tracker.new_run()
    last = replace(estimates(start, 2), next_stamp=END_OF_DATA)
    tracker.send(estimates(start, 0), estimates(start, 1), last)
    before = set(tracker.outputs[-1].id)
    tracker.outputs.clear()
    tracker.send(estimates(start, 0), estimates(start, 1))
    tracker.probe.wait_sentence(INPUT, "begin again", "everything was reset")
    tracker.assert_pictures(start, range(2))
    assert before.isdisjoint(tracker.outputs[-1].id)


def test_a_late_reader_gets_the_current_picture(tracker: Tracker) -> None:
    start = tracker.new_run()
    tracker.send(*(estimates(start, number) for number in range(3)))
    heard: list[Any] = []
    tracker.probe.node.create_subscription(
        message_class(BEARING_TRACKS.message_type),
        BEARING_TRACKS.name,
        heard.append,
        quality_of_service.LATE_READER,
    )
    # Older ones may come through on the way, but the current one is the last.
    tracker.probe.wait(lambda: start + 2 * SECOND in stamps(heard), "the current picture")
    assert stamps(heard)[-1] == start + 2 * SECOND
