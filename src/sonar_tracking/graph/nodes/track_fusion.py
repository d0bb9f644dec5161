"""Node ``track_fusion``: all track lists and bearing tracks in, one track list out."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.fusion.foreign_lists import ForeignLists
from sonar_tracking.fusion.fusion_records import FusionFrame
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.graph.catalogue.fusion_nodes import TRACK_FUSION
from sonar_tracking.graph.catalogue.node_configuration import FusionInputConfiguration
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    ALIGNMENTS,
    BEARING_TRACKS,
    FUSED_TRACKS,
    ODOMETRY,
    OWN_TRACKS,
    PASSIVE_TRACKS,
    Topic,
)
from sonar_tracking.graph.message_writing.alignment_writing import alignments_to_message
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from sonar_tracking.graph.node_base.data_flow import DataInput, Received, input_concern
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.array_reading import measured_directions_from_message
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.own_ship_interpolation import interpolate_own_ship, motion_in_map
from sonar_tracking.records.commands import CommandKind, OperatorCommand
from sonar_tracking.records.time import NANOSECONDS


class TrackFusion(SonarNode):
    """Shell around :class:`sonar_tracking.fusion.track_fusion_stage.TrackFusionStage`.

    Everything of one stamp is one frame, in the order of the topics; every frame gives exactly one
    list. A message that cannot be read does not spoil the frame. Where other ships tell their
    tracks, those of own sensors go out first, and the list that holds both once theirs are known up
    to its stamp.
    """

    uses_rest_of_group = True

    def __init__(self) -> None:
        super().__init__(TRACK_FUSION)
        self._configuration = self.configuration(TrackFusionConfiguration)
        inputs = self.configuration(FusionInputConfiguration)
        self._active = _topics(ACTIVE_TRACKS, inputs.active_topics)
        self._bearings = _topics(BEARING_TRACKS, inputs.bearing_topics)
        self._passive = _topics(PASSIVE_TRACKS, inputs.passive_topics)
        count = len(self._active) + len(self._bearings) + len(self._passive)
        self._foreign = _topics(FUSED_TRACKS, inputs.foreign_topics)
        self._stage = TrackFusionStage(self._configuration, count)
        self._published = 0
        self._tracks = self.data_publisher(FUSED_TRACKS)
        self._alignments = self.data_publisher(ALIGNMENTS)
        self._own = self.data_publisher(OWN_TRACKS)
        # Without data of its own, the node makes its list whenever another ship tells one.
        self._exchanges = bool(count and self._foreign)
        lists = (*self._active, *self._passive, *(() if self._exchanges else self._foreign))
        self._lists = ForeignLists([topic.name for topic in self._foreign])
        group: dict[Topic, Callable[[Any], Any]] = {
            **dict.fromkeys(lists, position_tracks_from_message),
            **dict.fromkeys(self._bearings, measured_directions_from_message),
        }
        own_ship = OwnShipReader(partial(self.report_state, ODOMETRY))
        self.data_subscriptions(
            {},
            groups=[group],
            series={ODOMETRY: (own_ship, interpolate_own_ship)},
            needs_series=lambda record: self.expects(ODOMETRY),
        )
        self._others = {
            topic.name: self._listen_to(topic) for topic in self._foreign if self._exchanges
        }

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Feed everything of one stamp and publish the tracks."""
        for received in item.items.values():
            if received.rejection:
                self.tell_rejected(received, InputError(received.rejection))
        own_ship = item.series[ODOMETRY.name]
        frame = FusionFrame(
            stamp=item.stamp,
            active={one.name: records[one.name] for one in self._active if one.name in records},
            bearings=tuple(records[one.name] for one in self._bearings if one.name in records),
            passive={one.name: records[one.name] for one in self._passive if one.name in records},
            own_ship=None if own_ship is None else motion_in_map(own_ship),
            foreign={one.name: records[one.name] for one in self._foreign if one.name in records},
        )
        return self._advance(frame)

    def substitute(self, rejected: Received) -> None:
        """Publish the tracks predicted to a stamp at which something unexpected went wrong."""
        if rejected.stamp > self._published:
            self._advance(FusionFrame(rejected.stamp))

    def carry_out(self, command: OperatorCommand) -> Iterable[Notice]:
        """End or merge tracks."""
        if command.kind is CommandKind.END_TRACK:
            self._stage.end_track(command.id)
        else:
            self._stage.merge_tracks(command.id, command.other_id)
        return ()

    def reset(self) -> None:
        """Forget all tracks; identifiers go on."""
        self._stage.reset()
        self._lists.clear()

    def state(self) -> tuple[TrackFusionStage, ForeignLists]:
        """Return the stage, and what waits for other ships."""
        return self._stage, self._lists

    def take_state(self, state: tuple[TrackFusionStage, ForeignLists]) -> None:
        """Go on with the tracks of the process before."""
        self._stage, self._lists = state
        self._stage.configuration = self._configuration
        self._stage.continue_from(self._configuration.first_id)

    def _advance(self, frame: FusionFrame) -> Iterable[Notice]:
        self._published = frame.stamp
        if self._exchanges:
            own = self._stage.own_picture(frame)
            self._own.publish(position_tracks_to_message(own.tracks))
            self._alignments.publish(alignments_to_message(own.alignments))
            self._lists.add_own(own)
            self._publish_both()
            return own.notices
        update = self._stage.update(frame)
        self._tracks.publish(position_tracks_to_message(update.tracks))
        if self._foreign:
            self._own.publish(position_tracks_to_message(update.own_tracks))
        self._alignments.publish(alignments_to_message(update.alignments))
        return update.notices

    def _publish_both(self) -> None:
        """Publish what waits for no other ship any more."""
        awaited = [name for name, source in self._others.items() if is_published(source)]
        for own, foreign in self._lists.ready(awaited):
            tracks, notices = self._stage.with_foreign(own, foreign)
            self._tracks.publish(position_tracks_to_message(tracks))
            for notice in notices:
                self.report(notice.culprit, notice.culprit, notice.severity, notice.text)

    def _listen_to(self, topic: Topic) -> DataInput:
        """Subscribe to the list of another ship, which no data of own sensors wait for."""
        source = DataInput(
            self,
            topic,
            topic.name,
            self.node_configuration.flow_depth,
            round(self.node_configuration.reset_after * NANOSECONDS),
            position_tracks_from_message,
            self._receive_foreign,
            self.progress,
            answered=False,
        )
        self.data_inputs.append(source)
        self.diagnostics.add(input_concern(source), source.values)
        return source

    def _receive_foreign(self, source: DataInput, message: Any) -> None:
        check, usable = source.judge(message)
        self.tell(source, check)
        for received in usable:
            self.take_in(source, received)
        self._publish_both()
        source.finish(source.read_stamp(message))

    def take_in(self, source: DataInput, received: Received) -> None:
        """Keep a list of another ship for the pictures that wait for it; join what else comes."""
        if source.topic.name in self._others:
            self._lists.add(source.topic.name, received.record)
        else:
            super().take_in(source, received)


def is_published(source: DataInput) -> bool:
    """Return whether somebody publishes an input."""
    return source.subscription.get_publisher_count() > 0


def _topics(kind: Topic, names: Iterable[str]) -> list[Topic]:
    return [replace(kind, name=name) for name in names if name]


def main() -> int:
    """Run the node."""
    return run_node(TrackFusion)


if __name__ == "__main__":
    sys.exit(main())
