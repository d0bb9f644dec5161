"""What the orchestration makes of the messages it sees: digests, latency, display, score."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.display.run_display import RunDisplay
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    CONTACTS,
    FUSED_TRACKS,
    PASSIVE_TRACKS,
    SNAPSHOTS,
    SUBSPACES,
    Topic,
    TopicRole,
)
from sonar_tracking.graph.orchestration.fused_latency_meter import FusedLatencyMeter
from sonar_tracking.graph.orchestration.latency_meter import LatencyMeter
from sonar_tracking.graph.orchestration.run_score import (
    RunScore,
    message_from_bytes,
    positions_from_bytes,
    tracks_from_bytes,
)
from sonar_tracking.graph.orchestration.topic_record import TopicRecord
from sonar_tracking.message_reading.array_reading import subspaces_from_message
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.time import nanoseconds

_CHAINS = (
    (SNAPSHOTS, SUBSPACES, BEARING_TRACKS),
    (CONTACTS, None, ACTIVE_TRACKS),
    (BEARING_TRACKS, None, PASSIVE_TRACKS),
)
"""Data of a sensor, what says which of them an estimate needs, and the tracks: the first chain
that is there is timed. Without estimates in between, tracks have the stamp of their data."""

_DATA_OF_ONE_STAMP = (CONTACTS.message_type, BEARING_TRACKS.message_type)
"""What sensors publish that belongs to one stamp."""


class RunObserver:
    """Takes every message of the graph, as serialised bytes.

    Parameters
    ----------
    topics : mapping of str to Topic
        All data topics by resolved name.
    display : RunDisplay
        Shown each estimated picture.
    cutoff_m : float
        Distance from which on the score takes a position track for none of a target, m.
    keep_steps : bool
        Keep digests of output topics after every message, to find the first that differs.
    naming : GraphNames
        Names of the topics the project knows.
    """

    def __init__(
        self,
        topics: Mapping[str, Topic],
        display: RunDisplay,
        cutoff_m: float,
        keep_steps: bool = False,
        naming: GraphNames = ROOT_NAMES,
    ) -> None:
        self.latency, self.fused_latency = LatencyMeter(), FusedLatencyMeter()
        self.records = {
            name: TopicRecord(topic.message_type, keep_steps and topic.role is TopicRole.OUTPUT)
            for name, topic in topics.items()
        }
        self._topics = topics
        self._naming = naming
        self._display = display
        self._fused = naming.of(FUSED_TRACKS)
        self._blocks, self._estimates, self._timed = _timed_chain(topics, naming)
        self._first_block = 0
        self._score = RunScore(topics, naming, cutoff_m)

    def announced(self, topic: str, stamp: int, wall: float) -> None:
        """Take the announcement of a message by its producer, just before it is published."""
        if topic == self._blocks:
            self.latency.block_published(stamp, wall)
        described = self._topics[topic]
        if described.role is TopicRole.INPUT and described.message_type in _DATA_OF_ONE_STAMP:
            self.fused_latency.data_published(stamp, wall)

    def replayed(self, topic: str, data: bytes, wall: float) -> None:
        """Take a message the orchestration has published itself."""
        stamp = head_stamp(data)
        if topic == self._blocks:
            if stamp == self._first_block:
                self.latency.begin_again()
                self.fused_latency.begin_again()
            self._first_block = self._first_block or stamp
        self.announced(topic, stamp, wall)
        self.records[topic].add(data)
        if self._topics[topic].role is TopicRole.TRUTH:
            self._score.take_truth(topic, data)

    def observed(self, topic: str, data: bytes, wall: float) -> None:
        """Take a message received from the graph."""
        self.records[topic].add(data)
        self._take_time(topic, data, wall)
        described = self._topics[topic]
        if described.role is TopicRole.TRUTH:
            self._score.take_truth(topic, data)
        elif described.message_type == BEARING_TRACKS.message_type:
            self._take_bearings(topic, tracks_from_bytes(data))
        elif described.message_type == PASSIVE_TRACKS.message_type:
            tracks = positions_from_bytes(data)
            self._score.take_positions(topic, tracks)
            self._display.position_tracks(topic, tracks)

    def score(self) -> Mapping[str, object]:
        """Return the score of the tracks against truth; see :class:`RunScore`."""
        return self._score.to_mapping()

    def _take_bearings(self, topic: str, tracks: BearingTracks) -> None:
        # Bearings simulated at a station are measurements, not tracks to be scored.
        if self._topics[topic].role is TopicRole.OUTPUT:
            self._score.take_bearings(topic, tracks)
            if topic == self._naming.of(BEARING_TRACKS):
                self._display.tracks(tracks)

    def _take_time(self, topic: str, data: bytes, wall: float) -> None:
        if topic == self._fused:
            self.fused_latency.list_received(head_stamp(data), wall)
        if topic == self._timed:
            stamp = head_stamp(data)
            if not self._estimates:
                self.latency.estimate_described(stamp, 0.0)
            self.latency.tracks_received(stamp, wall)
        elif topic == self._estimates:
            estimates = subspaces_from_message(message_from_bytes(data, SUBSPACES))
            if not math.isnan(estimates.newest_offset):
                self.latency.estimate_described(estimates.stamp, estimates.newest_offset)
                window_end = estimates.stamp + nanoseconds(estimates.newest_offset)
                published = self.latency.published_at(window_end)
                if not math.isnan(published):
                    self.fused_latency.data_published(estimates.stamp, published)


def _timed_chain(topics: Mapping[str, Topic], naming: GraphNames) -> tuple[str, str, str]:
    for blocks, estimates, tracks in _CHAINS:
        names = [naming.of(topic) if topic else "" for topic in (blocks, estimates, tracks)]
        if all(name in topics for name in names if name):
            return names[0], names[1], names[2]
    return "", "", ""
