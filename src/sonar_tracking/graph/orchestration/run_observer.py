"""What the orchestration makes of the messages it sees: digests, latency, display, score."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from rclpy.serialization import deserialize_message

from sonar_tracking.bags.storage.log_time import head_stamp
from sonar_tracking.display.run_display import RunDisplay
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    CONTACTS,
    PASSIVE_TRACKS,
    SNAPSHOTS,
    SUBSPACES,
    TRUE_BEARING_TRACKS,
    TRUE_TRACKS,
    Topic,
    TopicRole,
)
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.orchestration.latency_meter import LatencyMeter
from sonar_tracking.graph.orchestration.topic_record import TopicRecord
from sonar_tracking.message_reading.array_reading import (
    directions_from_message,
    subspaces_from_message,
)
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.positions import PositionTracks

_CHAINS = (
    (SNAPSHOTS, SUBSPACES, BEARING_TRACKS),
    (CONTACTS, None, ACTIVE_TRACKS),
    (BEARING_TRACKS, None, PASSIVE_TRACKS),
)
"""Data of a sensor, what says which of them an estimate needs, and the tracks: the first chain
that is there is timed. Without estimates in between, tracks have the stamp of their data."""


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
        self.latency = LatencyMeter()
        self.records = {
            name: TopicRecord(topic.message_type, keep_steps and topic.role is TopicRole.OUTPUT)
            for name, topic in topics.items()
        }
        self._topics = topics
        self._naming = naming
        self._display = display
        self._cutoff_m = cutoff_m
        self._blocks, self._estimates, self._timed = _timed_chain(topics, naming)
        self._first_block = 0
        self._bearings: list[BearingTracks] = []
        self._positions: dict[str, list[PositionTracks]] = {}
        self._truth: dict[str, list[bytes]] = {}
        self._scored = any(topic.role is TopicRole.TRUTH for topic in topics.values())

    def announced(self, topic: str, stamp: int, wall: float) -> None:
        """Take the announcement of a message by its producer, just before it is published."""
        if topic == self._blocks:
            self.latency.block_published(stamp, wall)

    def replayed(self, topic: str, data: bytes, wall: float) -> None:
        """Take a message the orchestration has published itself."""
        stamp = head_stamp(data)
        if topic == self._blocks:
            if stamp == self._first_block:
                self.latency.begin_again()
            self._first_block = self._first_block or stamp
        self.announced(topic, stamp, wall)
        self.records[topic].add(data)
        if self._topics[topic].role is TopicRole.TRUTH:
            self._take_truth(topic, data)

    def observed(self, topic: str, data: bytes, wall: float) -> None:
        """Take a message received from the graph."""
        self.records[topic].add(data)
        self._take_time(topic, data, wall)
        described = self._topics[topic]
        if described.role is TopicRole.TRUTH:
            self._take_truth(topic, data)
        elif described.message_type == BEARING_TRACKS.message_type:
            self._take_bearings(topic, tracks_from_bytes(data))
        elif described.message_type == PASSIVE_TRACKS.message_type:
            tracks = _position_tracks(data)
            if self._scored:
                self._positions.setdefault(topic, []).append(tracks)
            self._display.position_tracks(topic, tracks)

    def score(self) -> Mapping[str, object]:
        """Return the score of the tracks against truth; empty if either is missing.

        Bearings are scored at the top, positions under ``positions`` by topic.
        """
        score: dict[str, object] = {}
        true_bearings = self._truth.get(self._naming.of(TRUE_BEARING_TRACKS))
        if true_bearings and self._bearings:
            from sonar_tracking.evaluation.metrics.bearing_score import score_bearing_tracks

            truth = [tracks_from_bytes(data) for data in true_bearings]
            score |= score_bearing_tracks(truth, self._bearings).to_mapping()
        true_positions = self._truth.get(self._naming.of(TRUE_TRACKS))
        if true_positions and self._positions:
            from sonar_tracking.evaluation.metrics.position_score import score_position_tracks

            places = [_position_tracks(data) for data in true_positions]
            score["positions"] = {
                topic: score_position_tracks(places, tracks, self._cutoff_m).to_mapping()
                for topic, tracks in self._positions.items()
            }
        return score

    def _take_truth(self, topic: str, data: bytes) -> None:
        """Keep a true picture; it is decoded when the run is scored."""
        self._truth.setdefault(topic, []).append(data)

    def _take_bearings(self, topic: str, tracks: BearingTracks) -> None:
        # Bearings simulated at a station are measurements, not tracks to be scored.
        if (
            topic == self._naming.of(BEARING_TRACKS)
            and self._topics[topic].role is TopicRole.OUTPUT
        ):
            if self._scored:
                self._bearings.append(tracks)
            self._display.tracks(tracks)

    def _take_time(self, topic: str, data: bytes, wall: float) -> None:
        if topic == self._timed:
            stamp = head_stamp(data)
            if not self._estimates:
                self.latency.estimate_described(stamp, 0.0)
            self.latency.tracks_received(stamp, wall)
        elif topic == self._estimates:
            estimates = subspaces_from_message(_message(data, SUBSPACES))
            if not math.isnan(estimates.newest_offset):
                self.latency.estimate_described(estimates.stamp, estimates.newest_offset)


def _timed_chain(topics: Mapping[str, Topic], naming: GraphNames) -> tuple[str, str, str]:
    for blocks, estimates, tracks in _CHAINS:
        names = [naming.of(topic) if topic else "" for topic in (blocks, estimates, tracks)]
        if all(name in topics for name in names if name):
            return names[0], names[1], names[2]
    return "", "", ""


def _message(data: bytes, topic: Topic) -> Any:
    return deserialize_message(data, message_class(topic.message_type))


def tracks_from_bytes(data: bytes) -> BearingTracks:
    """Return the bearing tracks a serialised message carries."""
    return directions_from_message(_message(data, BEARING_TRACKS))


def _position_tracks(data: bytes) -> PositionTracks:
    return position_tracks_from_message(_message(data, PASSIVE_TRACKS))
