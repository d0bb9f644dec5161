"""Parameters of what listens to navigation receivers and to AIS."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter

_ADDRESS = (
    "where to listen: 0.0.0.0 = all addresses of this machine and broadcasts; or a group, e.g. "
    "239.192.0.1"
)


@dataclass(frozen=True)
class OwnShipNmeaConfiguration:
    """Parameters of the node ``own_ship_nmea``."""

    address: str = parameter("0.0.0.0", _ADDRESS)
    port: int = parameter(
        10110, "UDP port sentences come to: GGA, RMC, HDT, VTG, VHW, ZDA", minimum=1, maximum=65535
    )
    datum: str = parameter(
        "",
        "latitude and longitude of the origin of map, degrees, e.g. 54.18,7.89; empty = the first "
        "position",
    )


@dataclass(frozen=True)
class AisTruthConfiguration:
    """Parameters of the node ``ais_truth``."""

    address: str = parameter("0.0.0.0", _ADDRESS)
    port: int = parameter(
        10110, "UDP port sentences VDM come to, with RMC, ZDA or not", minimum=1, maximum=65535
    )
    datum: str = parameter(
        "",
        "latitude and longitude of the origin of map, degrees, e.g. 54.18,7.89; empty = that which "
        "own_ship_nmea tells on map/datum",
    )
    period: float = parameter(1.0, "between two pictures", unit="s", minimum=0.1, maximum=60.0)
    delay: float = parameter(
        10.0,
        "a picture waits so long for reports after its instant, to interpolate",
        unit="s",
        minimum=0.0,
        maximum=600.0,
    )
    longest_prediction: float = parameter(
        35.0,
        "for so long after its last report a ship that moves is predicted, as coasted; one that "
        "lies still for 7 minutes",
        unit="s",
        minimum=0.0,
        maximum=600.0,
    )
