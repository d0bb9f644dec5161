"""Files of positions of own ship: tables, or logs of NMEA 0183, one or several that follow."""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.positions.given_files import Files, logs_beside_tables
from sonar_tracking.bags.positions.joined_positions import joined_positions
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLog, NmeaLogs, epochs_of_logs
from sonar_tracking.bags.positions.nmea_tracks import own_ship_of_log
from sonar_tracking.bags.positions.position_tables import own_ship_of_table
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions


def read_own_ship(
    given: Files, epoch: int, origin: MapOrigin | None = None, logs: NmeaLogs | None = None
) -> tuple[SurveyedPositions, tuple[str, ...]]:
    """Read own ship's track; return it and a sentence for what was left out or assumed.

    Parameters
    ----------
    given : Path, str, or sequence of them
        CSV, npz, or logs of NMEA 0183; several follow one another, in any order.
    epoch : int
        Instant of ``time_s`` = 0, and date of a log that has none, ns.
    origin : MapOrigin, optional
        The datum; default: of these files alone.
    logs : NmeaLogs, optional
        Logs that were read already.

    Raises
    ------
    ConfigurationError
        If a file cannot be read or tells no position.
    """
    origin, logs = origin or MapOrigin(), logs or NmeaLogs()
    notes: list[str] = []
    tracks: list[SurveyedPositions] = []

    def take_table(path: Path) -> None:
        track, told = own_ship_of_table(path, epoch, origin)
        tracks.append(track)
        notes.extend(told)

    told_by = logs_beside_tables(given, take_table, NmeaLog.check_own_ship, logs, notes)
    for log, day in zip(told_by, epochs_of_logs(told_by, epoch), strict=True):
        track, told = own_ship_of_log(log, day, origin)
        tracks.append(track)
        notes.extend(told)
    return joined_positions(tracks, notes), tuple(dict.fromkeys(notes))
