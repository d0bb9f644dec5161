"""Node ``track_fusion``: all track lists and bearing tracks in, one track list out."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
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
from sonar_tracking.graph.node_base.data_flow import Received
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.array_reading import measured_directions_from_message
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.own_ship_interpolation import interpolate_own_ship, motion_in_map
from sonar_tracking.records.commands import CommandKind, OperatorCommand


class TrackFusion(SonarNode):
    """Shell around :class:`sonar_tracking.fusion.track_fusion_stage.TrackFusionStage`.

    Everything of one stamp is one frame, in the order of the topics; every frame gives exactly one
    list. A message that cannot be read does not spoil the frame.
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
        lists = (*self._active, *self._passive, *self._foreign)
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
        update = self._stage.update(frame)
        self._publish(update)
        return update.notices

    def substitute(self, rejected: Received) -> None:
        """Publish the tracks predicted to a stamp at which something unexpected went wrong."""
        if rejected.stamp > self._published:
            self._publish(self._stage.update(FusionFrame(rejected.stamp)))

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

    def state(self) -> TrackFusionStage:
        """Return the stage."""
        return self._stage

    def take_state(self, state: TrackFusionStage) -> None:
        """Go on with the tracks of the process before."""
        self._stage = state
        self._stage.configuration = self._configuration
        self._stage.continue_from(self._configuration.first_id)

    def _publish(self, update: FusionUpdate) -> None:
        tracks = update.tracks
        self._published = tracks.stamp
        self._tracks.publish(position_tracks_to_message(tracks))
        if self._foreign:
            self._own.publish(position_tracks_to_message(update.own_tracks))
        self._alignments.publish(alignments_to_message(update.alignments))


def _topics(kind: Topic, names: Iterable[str]) -> list[Topic]:
    return [replace(kind, name=name) for name in names if name]


def main() -> int:
    """Run the node."""
    return run_node(TrackFusion)


if __name__ == "__main__":
    sys.exit(main())
