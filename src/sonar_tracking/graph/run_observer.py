"""What the orchestration makes of the messages it sees: digests, latency, display, score."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from rclpy.serialization import deserialize_message

from sonar_tracking.bags.log_time import head_stamp
from sonar_tracking.graph.graph_plan import resolved
from sonar_tracking.graph.latency_meter import LatencyMeter
from sonar_tracking.graph.message_fields import message_class
from sonar_tracking.graph.topic_record import TopicRecord
from sonar_tracking.graph.topics import (
    BEARING_TRACKS,
    SNAPSHOTS,
    SUBSPACES,
    TRUE_BEARING_TRACKS,
    Topic,
    TopicRole,
)
from sonar_tracking.messages.reading import bearing_tracks_from_message, subspaces_from_message
from sonar_tracking.passive.records import BearingTracks, SubspaceEstimates

_BLOCKS = resolved(SNAPSHOTS)
_ESTIMATES = resolved(SUBSPACES)
_TRACKS = resolved(BEARING_TRACKS)
_TRUTH = resolved(TRUE_BEARING_TRACKS)

TakeTracks = Callable[[BearingTracks], None]


class RunObserver:
    """Takes every message of the graph, as serialised bytes.

    Parameters
    ----------
    topics : mapping of str to Topic
        All data topics by resolved name.
    on_tracks : callable
        Called with each estimated picture.
    keep_steps : bool
        Keep digests of output topics after every message, to find the first that differs.
    """

    def __init__(
        self,
        topics: Mapping[str, Topic],
        on_tracks: TakeTracks,
        keep_steps: bool = False,
    ) -> None:
        self.latency = LatencyMeter()
        self.records = {
            name: TopicRecord(topic.message_type, keep_steps and topic.role is TopicRole.OUTPUT)
            for name, topic in topics.items()
        }
        self._on_tracks = on_tracks
        self._tracks: list[BearingTracks] = []
        self._truth: list[bytes] = []

    def announced(self, topic: str, stamp: int, wall: float) -> None:
        """Take the announcement of a message by its producer, just before it is published."""
        if topic == _BLOCKS:
            self.latency.block_published(stamp, wall)

    def replayed(self, topic: str, data: bytes, wall: float) -> None:
        """Take a message the orchestration has published itself."""
        self.announced(topic, head_stamp(data), wall)
        self.records[topic].add(data)

    def observed(self, topic: str, data: bytes, wall: float) -> None:
        """Take a message received from the graph."""
        self.records[topic].add(data)
        if topic == _TRACKS:
            self.latency.tracks_received(head_stamp(data), wall)
            self._tracks.append(tracks_from_bytes(data))
            self._on_tracks(self._tracks[-1])
        elif topic == _TRUTH:
            self.take_truth(data)
        elif topic == _ESTIMATES:
            estimates = subspaces_from_bytes(data)
            if not math.isnan(estimates.newest_offset):
                self.latency.estimate_described(estimates.stamp, estimates.newest_offset)

    def take_truth(self, data: bytes) -> None:
        """Take a true picture; it is decoded when the run is scored."""
        self._truth.append(data)

    def score(self) -> Mapping[str, object]:
        """Return the score of the tracks against truth; empty if either is missing."""
        if not self._truth or not self._tracks:
            return {}
        from sonar_tracking.evaluation.bearing_score import score_bearing_tracks

        truth = [tracks_from_bytes(data) for data in self._truth]
        return score_bearing_tracks(truth, self._tracks).to_mapping()


def tracks_from_bytes(data: bytes) -> BearingTracks:
    """Return the bearing tracks a serialised message carries."""
    message = deserialize_message(data, message_class(BEARING_TRACKS.message_type))
    return bearing_tracks_from_message(message)


def subspaces_from_bytes(data: bytes) -> SubspaceEstimates:
    """Return the subspace estimates a serialised message carries."""
    message = deserialize_message(data, message_class(SUBSPACES.message_type))
    return subspaces_from_message(message)
