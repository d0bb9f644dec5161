"""A live track_fusion: one list a stamp, misalignment, bad input."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.fusion.fusion_records import FusionFrame
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    ALIGNMENTS,
    BEARING_TRACKS,
    FUSED_TRACKS,
    OWN_TRACKS,
)
from sonar_tracking.graph.message_writing.array_writing import bearing_tracks_to_message
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from sonar_tracking.message_reading.alignment_reading import alignments_from_message
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.positions import TrackSource
from sonar_tracking.records.time import NANOSECONDS
from tests.fusion.fusion_scene import ARRAY, ECHOES, FOUR, Ships, moments
from tests.graph.live_graph import NodeProcess, Probe, node_process, stamps

NODE = "track_fusion"
SHIPS = Ships(FOUR, misalignment=float(np.radians(1.5)))
FIRST_ID = 1 + (1 << 32)
OTHER = replace(OWN_TRACKS, name="consort/own_tracks")
IN_QUEUES = 6
"""Frames that may be on their way; the first of a run waits for the next one."""


class Fusion:
    """A live node and the means to feed it."""

    def __init__(self, process: NodeProcess, probe: Probe) -> None:
        self.process, self.probe = process, probe
        self.lists = probe.listen(FUSED_TRACKS)
        self.alignments = probe.listen(ALIGNMENTS)
        self._echoes = probe.publisher(ACTIVE_TRACKS)
        self._bearings = probe.publisher(BEARING_TRACKS)
        self._shift = self._sent = 0

    def new_run(self) -> None:
        """Begin so far back that the node begins again."""
        self._shift -= 10_000 * NANOSECONDS
        self._sent = 0
        self.lists.clear()
        self.alignments.clear()
        self.probe.diagnostics.clear()

    def moved(self, frame: FusionFrame) -> FusionFrame:
        """Return a frame at the times of this run."""

        def later(record):  # type: ignore[no-untyped-def]
            stamp, next_stamp = record.stamp + self._shift, record.next_stamp + self._shift
            return replace(record, stamp=stamp, next_stamp=next_stamp)

        return replace(
            frame,
            stamp=frame.stamp + self._shift,
            active={name: later(one) for name, one in frame.active.items()},
            bearings=tuple(later(one) for one in frame.bearings),
            own_ship=None,
        )

    def send(self, frame: FusionFrame) -> None:
        """Publish what belongs to one stamp; the queues are short."""
        for bearings in frame.bearings:
            self._bearings.publish(bearing_tracks_to_message(bearings))
        for tracks in frame.active.values():
            self._echoes.publish(position_tracks_to_message(tracks))
        self._sent += 1
        self.wait_lists(self._sent - IN_QUEUES)

    def wait_lists(self, count: int = 0) -> None:
        """Wait for so many lists, or for those of all frames of the run."""
        count = count or self._sent
        what = f"{count} lists; output:\n{self.process.output}"
        self.probe.wait(lambda: len(self.lists) >= count, what)


@pytest.fixture(scope="module")
def fusion(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Fusion]:
    log = tmp_path_factory.mktemp("fusion") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "travel_time": False,
        "passive_topics": "['']",
        "first_id": FIRST_ID,
    }
    probe = Probe()
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        fusion = Fusion(process, probe)
        probe.wait_matched(NODE, "/active/tracks", "/passive/bearing_tracks", "/tracks")
        yield fusion
    probe.close()


def test_the_node_gives_what_the_stage_gives(fusion: Fusion) -> None:
    fusion.new_run()
    settings = TrackFusionConfiguration(travel_time=False, first_id=FIRST_ID)
    stage = TrackFusionStage(settings, n_sources=2)
    expected = []
    for moment in moments(SHIPS, 120.0):
        frame = fusion.moved(moment.frame)
        fusion.send(frame)
        expected.append(stage.update(frame))
    fusion.wait_lists()
    assert stamps(fusion.lists) == [one.tracks.stamp for one in expected]
    for message, update in zip(fusion.lists, expected, strict=True):
        found = position_tracks_from_message(message)
        assert np.array_equal(found.id, update.tracks.id)
        assert np.array_equal(found.state, update.tracks.state)
        assert np.array_equal(found.covariance, update.tracks.covariance)
        assert found.next_stamp == update.tracks.next_stamp
    assert set(found.source) == {TrackSource.FUSED} and len(found) == 4
    told = alignments_from_message(fusion.alignments[-1])
    assert told.sensor_id == (ARRAY,)
    assert abs(np.degrees(told.misalignment[0]) - 1.5) < 0.6


def test_rows_that_are_impossible_are_named_and_the_rest_is_fused(fusion: Fusion) -> None:
    fusion.new_run()
    for moment in moments(SHIPS, 40.0):
        frame = moment.frame
        if frame.active and moment.time == 20.0:
            tracks = frame.active[ECHOES]
            noise = tracks.measurement_covariance.copy()
            noise[0] = -1.0
            frame = replace(frame, active={ECHOES: replace(tracks, measurement_covariance=noise)})
        fusion.send(fusion.moved(frame))
    fusion.wait_lists()
    fusion.probe.wait_sentence(f"{NODE}: data of active/tracks", "track 101", "check the sender")
    assert len(position_tracks_from_message(fusion.lists[-1])) == 4


@pytest.fixture
def exchanging(tmp_path: Path) -> Iterator[Fusion]:
    """Yield a node that takes the tracks of another ship."""
    parameters = {
        "use_sim_time": True,
        "travel_time": False,
        "passive_topics": "['']",
        "foreign_topics": f"[{OTHER.name}]",
    }
    probe = Probe()
    log = tmp_path / "log.txt"
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        fusion = Fusion(process, probe)
        probe.wait_matched(NODE, "/active/tracks", "/passive/bearing_tracks", "/tracks")
        yield fusion
    probe.close()


def test_data_may_begin_again_while_a_list_of_another_ship_is_set_aside(exchanging: Fusion) -> None:
    """The first list of a new run may come from the other ship: it is kept until own data come."""
    probe = exchanging.probe
    other = probe.publisher(OTHER)
    probe.wait_matched(NODE, f"/{OTHER.name}")
    shown = [moment.frame for moment in moments(SHIPS, 60.0)]
    echoes = [frame.active for frame in shown if frame.active]
    own, heard = probe.listen(OWN_TRACKS), 0
    exchanging.lists = own  # those of both wait for the other ship
    for told in (5, 1):
        for lists in echoes[:told]:
            (tracks,) = exchanging.moved(FusionFrame(0, active=lists)).active.values()
            other.publish(position_tracks_to_message(tracks))
            heard += 1
            probe.wait_for_count(
                lambda: probe.finished(NODE, f"/{OTHER.name}"), heard, "of the other"
            )
        for frame in shown:
            exchanging.send(exchanging.moved(frame))
        what = f"own lists; output:\n{exchanging.process.output}"
        probe.wait_for_count(lambda: len(own), len(shown) - 1, what)
        assert exchanging.process.is_alive
        assert "Traceback" not in exchanging.process.output
        exchanging.new_run()
