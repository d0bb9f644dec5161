"""Files of positions of own ship: tables, or logs of NMEA 0183, one or several that follow."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from sonar_tracking.bags.audio.recorded_files import natural_order
from sonar_tracking.bags.importers.joined_positions import joined_positions
from sonar_tracking.bags.importers.map_origin import MapOrigin
from sonar_tracking.bags.importers.nmea_log import (
    NmeaLog,
    NmeaLogs,
    epochs_of_logs,
    looks_like_nmea,
)
from sonar_tracking.bags.importers.nmea_tracks import own_ship_of_log
from sonar_tracking.bags.importers.position_tables import own_ship_of_table
from sonar_tracking.bags.importers.surveyed_positions import SurveyedPositions
from sonar_tracking.errors import ConfigurationError

Files = Path | str | Sequence[Path | str]
"""A file, a directory of files, or several of either."""

_Read = TypeVar("_Read")


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

    def read(path: Path) -> NmeaLog | None:
        """Read a table, or return the log that is to be read with the others."""
        if looks_like_nmea(path):
            log = logs.read(path)
            log.check_own_ship()
            return log
        track, told = own_ship_of_table(path, epoch, origin)
        tracks.append(track)
        notes.extend(told)
        return None

    told_by = [log for log in read_each(given, read, notes) if log is not None]
    for log, day in zip(told_by, epochs_of_logs(told_by, epoch), strict=True):
        track, told = own_ship_of_log(log, day, origin)
        tracks.append(track)
        notes.extend(told)
    return joined_positions(tracks, notes), tuple(dict.fromkeys(notes))


def given_paths(given: Files) -> list[Path]:
    """Return the files and directories that are given."""
    return [Path(each) for each in ([given] if isinstance(given, Path | str) else given)]


def files_text(given: Files) -> str:
    """Return how files are called in sentences."""
    paths = given_paths(given)
    return str(paths[0]) + (f" and {len(paths) - 1} more" if len(paths) > 1 else "")


def read_each(given: Files, read: Callable[[Path], _Read], notes: list[str]) -> list[_Read]:
    """Read files; one of a directory that cannot be is left out, and told.

    Parameters
    ----------
    given : Path, str, or sequence of them
        Files and directories.
    read : callable
        Reads one.
    notes : list of str
        Told what was left out.

    Raises
    ------
    ConfigurationError
        If a file that was named cannot be read, or none of a directory.
    """
    done: list[_Read] = []
    for path in given_paths(given):
        if not path.is_dir():
            done.append(read(path))
            continue
        failed: list[ConfigurationError] = []
        found = files_in(path)
        for file in found:
            try:
                done.append(read(file))
            except ConfigurationError as error:
                failed.append(error)
        if len(failed) == len(found):
            raise failed[0]
        notes.extend(f"{error} It is left out." for error in failed)
    return done


def files_in(directory: Path) -> list[Path]:
    """Return the files of a directory in natural order, hidden ones left out.

    Parameters
    ----------
    directory : Path
        Where they are.

    Raises
    ------
    ConfigurationError
        If there is none, or the directory cannot be read.
    """
    try:
        found = [each for each in directory.iterdir() if each.is_file()]
    except OSError as error:
        reason = f"The directory {directory} cannot be read ({error.strerror})."
        raise ConfigurationError(reason) from error
    found = [each for each in found if not each.name.startswith(".")]
    if not found:
        raise ConfigurationError(f"The directory {directory} has no file; give another.")
    return sorted(found, key=lambda each: natural_order(each.name))
