"""Node ``own_ship_nmea``: own ship from a navigation receiver, NMEA 0183 over UDP."""

from __future__ import annotations

import sys

from sonar_tracking.bags.nmea.live_own_ship import LiveOwnShip
from sonar_tracking.bags.nmea.nmea_input_configuration import OwnShipNmeaConfiguration
from sonar_tracking.graph.catalogue.nmea_nodes import OWN_SHIP_NMEA
from sonar_tracking.graph.catalogue.topics import ODOMETRY
from sonar_tracking.graph.message_writing.simulated_writing import own_ship_to_bytes
from sonar_tracking.graph.node_base.datum_topic import DatumTeller
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sentence_input import SentenceInput
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.records.datum import datum_if_told
from sonar_tracking.records.own_ship import OwnShipState


class OwnShipNmea(SonarNode):
    """Shell around :class:`sonar_tracking.bags.nmea.live_own_ship.LiveOwnShip`.

    Stamps are the times of the sentences, whatever the clocks of this machine show.
    """

    def __init__(self) -> None:
        super().__init__(OWN_SHIP_NMEA)
        configuration = self.configuration(OwnShipNmeaConfiguration, check=_check)
        datum = configuration.datum
        self._live = LiveOwnShip(datum_if_told(datum, "datum"))
        self._odometry = self.data_publisher(ODOMETRY)
        self._teller = DatumTeller(self)
        self._teller.tell(self._live.datum)
        SentenceInput(
            self,
            self.diagnostics,
            configuration.address,
            configuration.port,
            lambda line: self._publish(self._live.take(line)),
            self._live.used,
            self._live.faults,
            lambda: self._publish(self._live.close()),
        )

    def _publish(self, state: OwnShipState | None) -> None:
        if state is None:
            return
        self._teller.tell(self._live.datum)
        self.diagnostics.advance(state.stamp)
        self._odometry.publish(own_ship_to_bytes(state))


def _check(configuration: OwnShipNmeaConfiguration) -> None:
    """Refuse a datum that cannot be used."""
    datum_if_told(configuration.datum, "datum")


def main() -> int:
    """Run the node."""
    return run_node(OwnShipNmea)


if __name__ == "__main__":
    sys.exit(main())
