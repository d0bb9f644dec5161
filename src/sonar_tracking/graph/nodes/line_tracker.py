"""Node ``line_tracker``: element time series and bearing tracks in, frequency lines out."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from typing import Any

from sonar_tracking.errors import Notice
from sonar_tracking.graph.catalogue.passive_nodes import LINE_TRACKER
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, FREQUENCY_LINES, LOFAR, SAMPLES
from sonar_tracking.graph.message_writing.line_writing import frequency_lines_to_message
from sonar_tracking.graph.message_writing.sample_writing import lofar_rows_to_message
from sonar_tracking.graph.node_base.data_flow import Received
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.array_reading import bearing_tracks_from_message
from sonar_tracking.message_reading.field_reading import sensor
from sonar_tracking.message_reading.sample_reading import samples_from_message
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.lines.line_tracker_stage import LineTrackerStage
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import no_lines
from sonar_tracking.records.time import END_OF_DATA


class LineTracker(SonarNode):
    """Shell around :class:`sonar_tracking.passive.lines.line_tracker_stage.LineTrackerStage`.

    Samples wait until the bearings up to their begin are known. Every frame gives exactly one list
    of lines, and a row of the LOFAR picture for each beam if its samples are there.
    """

    def __init__(self) -> None:
        super().__init__(LINE_TRACKER)
        configuration = self.configuration(LineTrackerConfiguration, check=LineTrackerStage)
        self._stage = LineTrackerStage(configuration)
        self._pictures: list[BearingTracks] = []
        self._lines = self.data_publisher(FREQUENCY_LINES)
        self._lofar = self.data_publisher(LOFAR)
        self.data_subscriptions(
            {SAMPLES: samples_from_message, BEARING_TRACKS: bearing_tracks_from_message}
        )

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Keep the bearings; feed one block and publish the frames it completes."""
        if item.topic == BEARING_TRACKS.name:
            self._pictures.append(records[item.topic])
            return ()
        pictures, self._pictures = self._pictures, []
        notices: list[Notice] = []
        for update in self._stage.update(records[item.topic], pictures):
            if update.rows is not None:
                self._lofar.publish(lofar_rows_to_message(update.rows))
            self._lines.publish(frequency_lines_to_message(update.lines))
            notices.extend(update.notices)
        return notices

    def substitute(self, rejected: Received) -> None:
        """Pass the end of the data on, even with samples that could not be used."""
        if rejected.source.topic is SAMPLES and rejected.next_stamp == END_OF_DATA:
            lines = no_lines(rejected.stamp, END_OF_DATA, sensor(rejected.message))
            self._lines.publish(frequency_lines_to_message(lines))

    def warm_up(self) -> None:
        """Let the stage load what its first data need."""
        self._stage.warm_up()

    def reset(self) -> None:
        """Forget all lines and bearings; identifiers go on."""
        self._stage.reset()
        self._pictures = []


def main() -> int:
    """Run the node."""
    return run_node(LineTracker)


if __name__ == "__main__":
    sys.exit(main())
