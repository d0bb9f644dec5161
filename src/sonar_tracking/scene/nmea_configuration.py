"""Parameters of what goes to a chart plotter."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter


@dataclass(frozen=True)
class NmeaOutputConfiguration:
    """Parameters of the node ``nmea_output``."""

    address: str = parameter(
        "127.0.0.1", "of the chart plotter; that of a broadcast or of a group reaches several"
    )
    port: int = parameter(10110, "UDP port it listens at", minimum=1, maximum=65535)
    datum: str = parameter(
        "",
        "latitude and longitude of the origin of map, degrees, e.g. 54.18,7.89, for the sentence "
        "TLL; empty = that of the scenario or recording, or on map/datum; without any, ranges and "
        "bearings from own ship alone",
    )
