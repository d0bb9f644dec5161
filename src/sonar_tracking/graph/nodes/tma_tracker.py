"""Node ``tma_tracker``: bearing tracks and frequency lines in, position tracks out."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.graph.catalogue.node_configuration import TmaInputConfiguration
from sonar_tracking.graph.catalogue.tma_nodes import TMA_TRACKER
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    FREQUENCY_LINES,
    ODOMETRY,
    PASSIVE_TRACKS,
    STATION_ALIGNMENTS,
    Topic,
)
from sonar_tracking.graph.message_writing.alignment_writing import alignments_to_message
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from sonar_tracking.graph.node_base.data_flow import Received
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.array_reading import (
    measured_directions_from_message,
)
from sonar_tracking.message_reading.line_reading import frequency_lines_from_message
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.motion import KinematicState
from sonar_tracking.own_ship_interpolation import interpolate_own_ship, motion_in_map
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.commands import CommandKind, OperatorCommand
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, UnusableBearings
from sonar_tracking.tma.targets.station_view import may_be_unset, needs_own_ship, with_pose_judged
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage

UNSEEN_TURNS = "unseen turns"
"""Concern: how long a turn of the target of each confirmed track would not show."""

SensorRecord = TypeVar("SensorRecord", BearingTracks, FrequencyLines)


class TmaTracker(SonarNode):
    """Shell around :class:`sonar_tracking.tma.tracker.tma_tracker_stage.TmaTrackerStage`.

    Bearings and lines of one stamp are one frame, in the order of the topics; every frame with
    bearings, usable or not, gives exactly one list, and the alignment of several stations. Odometry
    is waited for only where the data do not tell where their sensor is. A message that cannot be
    read does not spoil the frame: tracks of its station are predicted.
    """

    uses_rest_of_group = True

    def __init__(self) -> None:
        super().__init__(TMA_TRACKER)
        self._configuration = self.configuration(
            TmaTrackerConfiguration, check=TmaTrackerStage, take=self._reconfigure
        )
        inputs = self.configuration(TmaInputConfiguration)
        bearings = [replace(BEARING_TRACKS, name=name) for name in inputs.bearing_topics if name]
        lines = [replace(FREQUENCY_LINES, name=name) for name in inputs.line_topics if name]
        self._bearings = [topic.name for topic in bearings]
        self._lines = [topic.name for topic in lines]
        self._stage = TmaTrackerStage(self._configuration, len(bearings))
        self._published = 0
        self._tracks = self.data_publisher(PASSIVE_TRACKS)
        self._alignments = self.data_publisher(STATION_ALIGNMENTS)
        group: dict[Topic, Callable[[Any], Any]] = {
            **dict.fromkeys(bearings, measured_directions_from_message),
            **dict.fromkeys(lines, frequency_lines_from_message),
        }
        own_ship = OwnShipReader(partial(self.report_state, ODOMETRY))
        self.data_subscriptions(
            {},
            groups=[group],
            series={ODOMETRY: (own_ship, interpolate_own_ship)},
            needs_series=self._needs_own_ship,
        )
        self.diagnostics.add(UNSEEN_TURNS, self._unseen_turns)

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Feed everything of one stamp and publish the tracks."""
        unusable = []
        for topic, received in item.items.items():
            if received.rejection:
                self.tell_rejected(received, InputError(received.rejection))
                if topic in self._bearings:
                    unusable.append(_unusable(received))
        own_ship = item.series[ODOMETRY.name]
        motion = None if own_ship is None else motion_in_map(own_ship)
        usable = {
            topic: self._placed(item.items[topic], record, motion)
            for topic, record in records.items()
        }
        frame = PassiveFrame(
            stamp=item.stamp,
            bearings=tuple(usable[topic] for topic in self._bearings if topic in usable),
            lines=tuple(usable[topic] for topic in self._lines if topic in usable),
            own_ship=motion,
            unusable=tuple(unusable),
        )
        update = self._stage.update(frame)
        if update.tracks is not None:
            self._publish(update.tracks)
            if update.alignments is not None and len(self._bearings) > 1:
                next_stamp = update.tracks.next_stamp
                told = replace(update.alignments, next_stamp=next_stamp)
                self._alignments.publish(alignments_to_message(told))
        return update.notices

    def substitute(self, rejected: Received) -> None:
        """Publish the tracks predicted to a stamp at which something unexpected went wrong."""
        if rejected.source.topic.name not in self._bearings or rejected.stamp == self._published:
            return
        try:
            frame = PassiveFrame(rejected.stamp, unusable=(_unusable(rejected),))
            tracks = self._stage.update(frame).tracks
        except InputError:
            tracks = self._stage.picture()
        if tracks is not None:
            self._publish(tracks)

    def carry_out(self, command: OperatorCommand) -> Iterable[Notice]:
        """End a track, choose its side, or tell own ship's lines from others."""
        stage, kind = self._stage, command.kind
        if kind is CommandKind.END_TRACK:
            stage.end_track(command.id)
        elif kind is CommandKind.CHOOSE_SIDE:
            stage.choose_side(command.id, command.side.name.lower())
        elif kind is CommandKind.MARK_OWN_SHIP_LINE:
            stage.mark_own_ship_line(command.line)
        else:
            stage.unmark_own_ship_line(command.line)
        return ()

    def reset(self) -> None:
        """Forget all tracks; identifiers go on."""
        self._stage.reset()

    def state(self) -> TmaTrackerStage:
        """Return the stage."""
        return self._stage

    def take_state(self, state: TmaTrackerStage) -> None:
        """Go on with the tracks of the process before."""
        self._stage = state
        self._stage.configuration = self._configuration
        self._stage.continue_from(self._configuration.first_id)

    def _unseen_turns(self) -> dict[str, object]:
        turns = self._stage.unseen_turns()
        return {f"track {row}": f"{time:.0f} s" for row, time in turns.items()}

    def _reconfigure(self, configuration: TmaTrackerConfiguration) -> None:
        self._configuration = self._stage.configuration = configuration

    def _needs_own_ship(self, record: Any) -> bool:
        unset = may_be_unset(record.sensor) and self.expects(ODOMETRY)
        return unset or needs_own_ship(record.sensor, self._configuration)

    def _placed(
        self, received: Received, record: SensorRecord, motion: KinematicState | None
    ) -> SensorRecord:
        """Return a record whose sensor is unknown if nobody has set its pose."""
        sensor, notice = with_pose_judged(
            record.sensor, motion, self._configuration, self.expects(ODOMETRY)
        )
        self.report_state(received.source.topic, notice)
        return record if sensor is record.sensor else replace(record, sensor=sensor)

    def _publish(self, tracks: PositionTracks) -> None:
        self._published = tracks.stamp
        self._tracks.publish(position_tracks_to_message(tracks))


def _unusable(received: Received) -> UnusableBearings:
    return UnusableBearings(str(received.message.sensor_id), received.next_stamp)


def main() -> int:
    """Run the node."""
    return run_node(TmaTracker)


if __name__ == "__main__":
    sys.exit(main())
