"""Node ``nmea_output``: the fused tracks to chart plotters, as NMEA 0183 over UDP."""

from __future__ import annotations

import socket
import sys
from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any

from sonar_tracking.errors import ConfigurationError, Notice, Severity
from sonar_tracking.graph.catalogue.nmea_nodes import NMEA_OUTPUT
from sonar_tracking.graph.catalogue.topics import FUSED_TRACKS, ODOMETRY
from sonar_tracking.graph.node_base.datum_topic import listen_to_datum
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.own_ship_interpolation import interpolate_own_ship
from sonar_tracking.records.datum import Datum, datum_if_told
from sonar_tracking.scene.nmea_configuration import NmeaOutputConfiguration
from sonar_tracking.scene.nmea_sentences import TrackSentences

PLOTTER = "plotter"
"""Concern: what was sent."""


class NmeaOutput(SonarNode):
    """Shell around :class:`sonar_tracking.scene.nmea_sentences.TrackSentences`.

    Nothing is known of who listens; a datagram that cannot be sent is reported, and the next one
    tried.
    """

    def __init__(self) -> None:
        super().__init__(NMEA_OUTPUT)
        configuration = self.configuration(NmeaOutputConfiguration, check=_check)
        datum = configuration.datum
        self._sentences = TrackSentences(datum_if_told(datum, "datum"))
        if not datum:
            listen_to_datum(self, self._take_datum)
        self._address = (configuration.address, configuration.port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        self._socket.setblocking(False)
        own_ship = OwnShipReader(partial(self.report_state, ODOMETRY))
        self.data_subscriptions(
            {FUSED_TRACKS: position_tracks_from_message},
            series={ODOMETRY: (own_ship, interpolate_own_ship)},
            needs_series=lambda record: self.expects(ODOMETRY),
        )

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Send the sentences of one picture."""
        tracks, own_ship = records[FUSED_TRACKS.name], item.series[ODOMETRY.name]
        for sentence in self._sentences.of_picture(tracks, own_ship):
            try:
                self._socket.sendto(f"{sentence}\r\n".encode("ascii"), self._address)
            except OSError as error:
                address, port = self._address
                self.report(
                    PLOTTER,
                    "datagram",
                    Severity.WARN,
                    f"nothing can be sent to {address}, port {port} ({error.strerror}); see to the "
                    "network, or give another address.",
                )
        return ()

    def reset(self) -> None:
        """Begin to number the tracks again."""
        self._sentences = TrackSentences(self._sentences.datum)

    def _take_datum(self, datum: Datum) -> None:
        self._sentences.datum = datum


def _check(configuration: NmeaOutputConfiguration) -> None:
    """Refuse an address that is none, and a datum that cannot be used."""
    datum_if_told(configuration.datum, "datum")
    try:
        socket.getaddrinfo(configuration.address, configuration.port, socket.AF_INET)
    except OSError as error:
        raise ConfigurationError(
            f"address {configuration.address} cannot be found ({error.strerror}); give the IPv4 "
            "address of the chart plotter."
        ) from error


def main() -> int:
    """Run the node."""
    return run_node(NmeaOutput)


if __name__ == "__main__":
    sys.exit(main())
