"""Files of positions of own ship and of targets: tables, or logs of NMEA 0183."""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.importers.map_origin import MapOrigin
from sonar_tracking.bags.importers.nmea_log import (
    looks_like_nmea,
    own_ship_of_log,
    read_nmea_log,
)
from sonar_tracking.bags.importers.position_tables import own_ship_of_table
from sonar_tracking.bags.importers.surveyed_positions import SurveyedPositions


def read_own_ship(
    path: Path | str, epoch: int, origin: MapOrigin | None = None
) -> tuple[SurveyedPositions, tuple[str, ...]]:
    """Read own ship's track; return it and a sentence for what was left out or assumed.

    Parameters
    ----------
    path : Path or str
        CSV, npz, or a log of NMEA 0183.
    epoch : int
        Instant of ``time_s`` = 0, and date of a log that has none, ns.
    origin : MapOrigin, optional
        The datum; default: of this file alone.

    Raises
    ------
    ConfigurationError
        If it cannot be read or tells no position.
    """
    origin = origin or MapOrigin()
    if looks_like_nmea(path):
        return own_ship_of_log(read_nmea_log(path), epoch, origin)
    return own_ship_of_table(path, epoch, origin)
