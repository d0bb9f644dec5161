"""Node ``bearing_tracker``: signal subspaces in, the complete picture of bearing tracks out."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.graph.catalogue.passive_nodes import BEARING_TRACKER
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, SUBSPACES
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.graph.node_base.data_flow import Received
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.array_reading import subspaces_from_message
from sonar_tracking.message_reading.field_reading import sensor
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates
from sonar_tracking.records.commands import CommandKind, OperatorCommand


class BearingTracker(SonarNode):
    """Shell around the stage of :mod:`sonar_tracking.passive.bearings.bearing_tracker_stage`.

    Every estimate, usable or not, gives exactly one picture: without subspaces the tracks are
    predicted.
    """

    def __init__(self) -> None:
        super().__init__(BEARING_TRACKER)
        configuration = self.configuration(BearingTrackerConfiguration, check=BearingTrackerStage)
        self._stage = BearingTrackerStage(configuration)
        self._last_estimates: SubspaceEstimates | None = None
        self._tracks = self.data_publisher(BEARING_TRACKS)
        self.data_subscriptions({SUBSPACES: subspaces_from_message})

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Feed the subspaces of one sample time and publish the tracks."""
        estimates: SubspaceEstimates = records[SUBSPACES.name]
        notices = self._advance(estimates)
        self._last_estimates = estimates
        return notices

    def substitute(self, rejected: Received) -> None:
        """Publish the tracks predicted to the time of an estimate that could not be used."""
        if self._last_estimates is not None:
            try:
                self._advance(_without_subspaces(self._last_estimates, rejected))
                return
            except InputError:
                pass
        self._publish(
            replace(
                array_writing.NO_BEARING_TRACKS,
                stamp=rejected.stamp,
                next_stamp=rejected.next_stamp,
                sensor=sensor(rejected.message),
            )
        )

    def carry_out(self, command: OperatorCommand) -> Iterable[Notice]:
        """Start, end or merge tracks."""
        if command.kind is CommandKind.START_TRACK:
            self._stage.start_track(command.arrival_angle)
        elif command.kind is CommandKind.END_TRACK:
            self._stage.end_track(command.id)
        else:
            self._stage.merge_tracks(command.id, command.other_id)
        return ()

    def warm_up(self) -> None:
        """Let the stage do once what its first data need."""
        self._stage.warm_up()

    def reset(self) -> None:
        """Forget all tracks; identifiers go on."""
        self._stage.reset()
        self._last_estimates = None

    def state(self) -> tuple[BearingTrackerStage, SubspaceEstimates | None]:
        """Return the stage and what it was fed last."""
        return self._stage, self._last_estimates

    def take_state(self, state: tuple[BearingTrackerStage, SubspaceEstimates | None]) -> None:
        """Go on with the tracks of the process before."""
        first_id = self._stage.configuration.first_id
        self._stage, self._last_estimates = state
        self._stage.continue_from(first_id)

    def _advance(self, estimates: SubspaceEstimates) -> Iterable[Notice]:
        update = self._stage.update(estimates)
        self._publish(update.tracks)
        return update.notices

    def _publish(self, tracks: BearingTracks) -> None:
        self._tracks.publish(array_writing.bearing_tracks_to_message(tracks))


def _without_subspaces(last: SubspaceEstimates, rejected: Received) -> SubspaceEstimates:
    return replace(
        last,
        stamp=rejected.stamp,
        next_stamp=rejected.next_stamp,
        basis=last.basis[:0],
        time_offsets=np.empty(0),
        covariance=None,
        covariance_snapshots=0,
        covariance_time_offset=np.nan,
        eigenvalues=np.empty(0),
        rank=-1,
        source_count=-1,
        noise_power=np.array(np.nan),
    )


def main() -> int:
    """Run the node."""
    return run_node(BearingTracker)


if __name__ == "__main__":
    sys.exit(main())
