"""Files as they are given to an import: one, several that follow, or directories of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from sonar_tracking.bags.audio.recorded_files import natural_order
from sonar_tracking.bags.positions.nmea_log import NmeaLog, NmeaLogs, looks_like_nmea
from sonar_tracking.errors import ConfigurationError

Files = Path | str | Sequence[Path | str]
"""A file, a directory of files, or several of either."""

_Read = TypeVar("_Read")


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


def logs_beside_tables(
    given: Files,
    take_table: Callable[[Path], None],
    check_log: Callable[[NmeaLog], None],
    logs: NmeaLogs,
    notes: list[str],
) -> list[NmeaLog]:
    """Have the tables among some files taken, and return the logs: these are used together.

    Parameters
    ----------
    given : Path, str, or sequence of them
        Tables, logs of NMEA 0183, and directories of them.
    take_table : callable
        Reads a table.
    check_log : callable
        Refuses a log that is of no use.
    logs : NmeaLogs
        Logs that were read already.
    notes : list of str
        Told what was left out.

    Raises
    ------
    ConfigurationError
        As of :func:`read_each`.
    """

    def read(path: Path) -> NmeaLog | None:
        if not looks_like_nmea(path):
            take_table(path)
            return None
        log = logs.read(path)
        check_log(log)
        return log

    return [log for log in read_each(given, read, notes) if log is not None]
