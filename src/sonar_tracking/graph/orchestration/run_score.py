"""The score of a run against its truth, while it goes on and in memory that hardly grows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

from rclpy.serialization import deserialize_message

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.evaluation.metrics.bearing_score import OnlineBearingScore
from sonar_tracking.evaluation.metrics.position_score import OnlinePositionScore
from sonar_tracking.graph.catalogue.graph_names import GraphNames
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    PASSIVE_TRACKS,
    TRUE_BEARING_TRACKS,
    TRUE_TRACKS,
    Topic,
    TopicRole,
)
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.message_reading.array_reading import directions_from_message
from sonar_tracking.message_reading.identifier_reading import (
    bearing_identifiers,
    position_identifiers,
)
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.arrays import IdArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.positions import PositionTracks


class RunScore:
    """Scores bearing tracks, and position tracks by topic, where there is truth of their kind.

    Parameters
    ----------
    topics : mapping of str to Topic
        All data topics by resolved name.
    naming : GraphNames
        Names of the topics the project knows.
    cutoff_m : float
        Distance from which on a position track is none of a target, m.
    """

    def __init__(self, topics: Mapping[str, Topic], naming: GraphNames, cutoff_m: float) -> None:
        self._own_bearings = naming.of(BEARING_TRACKS)
        self._true_positions = naming.of(TRUE_TRACKS)
        self._truth_of = _true_bearings_of(topics, naming)
        self._bearings = {name: OnlineBearingScore() for name in self._truth_of}
        self._positions = {
            name: OnlinePositionScore(cutoff_m)
            for name, topic in topics.items()
            if topic.message_type == PASSIVE_TRACKS.message_type
            and topic.role is not TopicRole.TRUTH
            and self._true_positions in topics
        }

    def take_truth(self, topic: str, data: bytes) -> None:
        """Take a serialised true picture, if something is scored against it."""
        if topic in self._truth_of.values():
            sample = _TrueSample(data, bearing_identifiers(data), tracks_from_bytes)
            for name, truth in self._truth_of.items():
                if truth == topic:
                    self._bearings[name].add_truth(sample)
        elif topic == self._true_positions and self._positions:
            sample = _TrueSample(data, position_identifiers(data), positions_from_bytes)
            for score in self._positions.values():
                score.add_truth(sample)

    def take_bearings(self, topic: str, tracks: BearingTracks) -> None:
        """Take a list of bearing tracks."""
        if topic in self._bearings:
            self._bearings[topic].add_tracks(tracks)

    def take_positions(self, topic: str, tracks: PositionTracks) -> None:
        """Take a list of position tracks."""
        if topic in self._positions:
            self._positions[topic].add_tracks(tracks)

    def to_mapping(self) -> dict[str, object]:
        """Return the score; empty if tracks or truth are missing.

        Bearings of own ship's array are scored at the top, those of stations under ``bearings``,
        positions under ``positions``, both by topic.
        """
        bearings = {
            topic: online.score().to_mapping()
            for topic, online in self._bearings.items()
            if online.is_known
        }
        score: dict[str, object] = dict(bearings.pop(self._own_bearings, {}))
        score |= {"bearings": bearings} if bearings else {}
        positions = {
            topic: online.score().to_mapping()
            for topic, online in self._positions.items()
            if online.is_known
        }
        return score | ({"positions": positions} if positions else {})


def _true_bearings_of(topics: Mapping[str, Topic], naming: GraphNames) -> dict[str, str]:
    """Return the topics of bearing tracks that have true ones, with these: of the same station."""
    pairs = {naming.of(BEARING_TRACKS): naming.of(TRUE_BEARING_TRACKS)}
    for name, topic in topics.items():
        station = name.removesuffix(BEARING_TRACKS.name)
        # Bearings that a station delivers are measurements, not tracks to be scored.
        if station != name and topic.role is TopicRole.OUTPUT:
            pairs.setdefault(name, station + TRUE_BEARING_TRACKS.name)
    return {name: truth for name, truth in pairs.items() if {name, truth} <= topics.keys()}


class _TrueSample:
    """Truth at one instant, decoded when something is scored against it: most of it never is."""

    def __init__(self, data: bytes, identifiers: IdArray, decode: Callable[[bytes], Any]) -> None:
        self.stamp = head_stamp(data)
        self.id = identifiers
        self._data, self._decode = data, decode

    @cached_property
    def _record(self) -> Any:
        return self._decode(self._data)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._record, name)


def message_from_bytes(data: bytes, topic: Topic) -> Any:
    """Return a serialised message of a topic."""
    return deserialize_message(data, message_class(topic.message_type))


def tracks_from_bytes(data: bytes) -> BearingTracks:
    """Return the bearing tracks a serialised message carries."""
    return directions_from_message(message_from_bytes(data, BEARING_TRACKS))


def positions_from_bytes(data: bytes) -> PositionTracks:
    """Return the position tracks a serialised message carries."""
    return position_tracks_from_message(message_from_bytes(data, PASSIVE_TRACKS))
