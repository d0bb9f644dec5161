"""Node ``ais_truth``: the ships around by their AIS, NMEA 0183 over UDP, as the truth."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from typing import Any

from sonar_tracking.bags.nmea.live_ships import LiveShips
from sonar_tracking.bags.nmea.nmea_input_configuration import AisTruthConfiguration
from sonar_tracking.errors import Notice
from sonar_tracking.graph.catalogue.nmea_nodes import AIS_TRUTH
from sonar_tracking.graph.catalogue.topics import ODOMETRY, TRUE_TRACKS
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from sonar_tracking.graph.node_base.datum_topic import listen_to_datum
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sentence_input import SentenceInput
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.records.datum import Datum, datum_if_told
from sonar_tracking.records.positions import PositionTracks


class AisTruth(SonarNode):
    """Shell around :class:`sonar_tracking.bags.nmea.live_ships.LiveShips`.

    AIS tells the second of a report alone: the rest is of other sentences at the same port, or of
    own ship's odometry.
    """

    def __init__(self) -> None:
        super().__init__(AIS_TRUTH)
        configuration = self.configuration(AisTruthConfiguration, check=_check)
        datum = configuration.datum
        self._ships = LiveShips(configuration, datum_if_told(datum, "datum"))
        self._tracks = self.data_publisher(TRUE_TRACKS)
        self.data_subscriptions({ODOMETRY: OwnShipReader()})
        if not datum:
            listen_to_datum(self, self._take_datum)
        SentenceInput(
            self,
            self.diagnostics,
            configuration.address,
            configuration.port,
            lambda line: self._publish(self._ships.take(line)),
            self._ships.used,
            self._ships.faults,
        )

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Take the time of own ship."""
        self._publish(self._ships.take_time(item.stamp))
        return ()

    def _take_datum(self, datum: Datum) -> None:
        if self._ships.datum is None:
            self._ships.datum = datum

    def _publish(self, pictures: Iterable[PositionTracks]) -> None:
        for picture in pictures:
            self.diagnostics.advance(picture.stamp)
            self._tracks.publish(position_tracks_to_message(picture))


def _check(configuration: AisTruthConfiguration) -> None:
    """Refuse a datum that cannot be used."""
    datum_if_told(configuration.datum, "datum")


def main() -> int:
    """Run the node."""
    return run_node(AisTruth)


if __name__ == "__main__":
    sys.exit(main())
