"""Recorded contacts: a CSV or npz file with one line a contact, and where own ship was.

Columns of contacts:

=========================  =========================================================================
``time_s``                 of the ping, since the epoch; or ``unix_time_s``, since 1970
``range_m``                empty together with the direction: a ping without contacts
``bearing_deg``            compass, clockwise from north; or ``azimuth_deg``, anticlockwise from
                           east; or ``relative_bearing_deg``, clockwise from own ship's bow
``amplitude``              linear power, noise mean 1 (optional); or ``amplitude_db``
``range_deviation_m``      standard deviation of the range (optional; else one for all)
``bearing_deviation_deg``  standard deviation of the direction (optional; else one for all)
``own_east_m``             own ship (optional), with ``own_north_m`` and, optional,
                           ``own_heading_deg``, compass
=========================  =========================================================================

Lines of one time are one ping. Own ship may also come from a file of its own, with ``time_s`` or
``unix_time_s``, ``east_m``, ``north_m`` and, optional, ``heading_deg``; without either it rests at
the origin. True positions have ``time_s`` or ``unix_time_s``, ``target``, ``east_m``, ``north_m``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sonar_tracking.bags.importers.number_table import NumberTable, read_number_table
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import azimuth_from_compass, wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray
from sonar_tracking.records.time import NANOSECONDS

TIMES = ("time_s", "unix_time_s")
DIRECTIONS = ("bearing_deg", "azimuth_deg", "relative_bearing_deg")
AMPLITUDES = ("amplitude", "amplitude_db")
DEVIATIONS = ("range_deviation_m", "bearing_deviation_deg")
OWN_SHIP = ("own_east_m", "own_north_m", "own_heading_deg")
CONTACT_COLUMNS = ("range_m", *TIMES, *DIRECTIONS, *AMPLITUDES, *DEVIATIONS, *OWN_SHIP)


@dataclass(frozen=True)
class ContactLines:
    """Usable lines of a file of contacts, in order of time.

    Attributes
    ----------
    stamp : ndarray of int, shape (n,)
        Of the ping, ns.
    range : ndarray, shape (n,)
        m; NaN = the line only says that there was a ping.
    azimuth : ndarray, shape (n,)
        In ``map``, or from own ship's bow where ``relative``, anticlockwise, rad.
    relative : bool
        Whether azimuths are from own ship's bow.
    amplitude : ndarray, shape (n,) or (0,)
        Linear power; empty = not measured.
    range_deviation, azimuth_deviation : ndarray, shape (n,)
        m and rad; NaN = not given.
    own_ship : ndarray, shape (n, 3)
        East, north (m) and azimuth of the bow (rad); NaN = not given.
    bad : list of str
        A sentence for each line left out.
    """

    stamp: IntArray
    range: FloatArray
    azimuth: FloatArray
    relative: bool
    amplitude: FloatArray
    range_deviation: FloatArray
    azimuth_deviation: FloatArray
    own_ship: FloatArray
    bad: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class SurveyedPositions:
    """Positions by time, of own ship or of one target.

    Attributes
    ----------
    stamp : ndarray of int, shape (n,)
        Ascending, ns.
    position : ndarray, shape (n, 2)
        East, north, m.
    azimuth : ndarray, shape (n,)
        Of the bow, rad; NaN = not given.
    """

    stamp: IntArray
    position: FloatArray
    azimuth: FloatArray


def read_contact_lines(path: Path | str, epoch: int) -> ContactLines:
    """Read a file of contacts.

    Parameters
    ----------
    path : Path or str
        CSV or npz.
    epoch : int
        Instant of ``time_s`` = 0, ns.

    Raises
    ------
    ConfigurationError
        If it cannot be read or holds no usable line.
    """
    table = read_number_table(path, ("range_m",), CONTACT_COLUMNS)
    stamp = _stamps(table, epoch)
    direction = _one_of(table, DIRECTIONS)
    given = table.column(direction)
    if direction == "bearing_deg":
        azimuth = azimuth_from_compass(given)
    else:
        sign = 1.0 if direction == "azimuth_deg" else -1.0
        azimuth = sign * np.radians(given)
    amplitude = table.numbers.get("amplitude")
    if "amplitude_db" in table.numbers:
        amplitude = 10.0 ** (0.1 * table.numbers["amplitude_db"])
    heading = azimuth_from_compass(table.column("own_heading_deg"))
    own_ship = np.stack([table.column("own_east_m"), table.column("own_north_m"), heading], axis=1)
    bad = list(table.bad)
    good = _usable(table, stamp, direction, amplitude, bad)
    if not good.any():
        raise ConfigurationError(
            f"The file {table.path} holds no usable line. {' '.join(bad[:3])}".strip()
        )
    order = np.flatnonzero(good)
    order = order[np.argsort(stamp[order], kind="stable")]
    return ContactLines(
        stamp=stamp[order],
        range=table.column("range_m")[order],
        azimuth=wrap_angle(azimuth)[order],
        relative=direction == "relative_bearing_deg",
        amplitude=amplitude[order] if amplitude is not None else np.zeros(0),
        range_deviation=table.column("range_deviation_m")[order],
        azimuth_deviation=np.radians(table.column("bearing_deviation_deg"))[order],
        own_ship=own_ship[order],
        bad=bad,
    )


def read_own_ship(path: Path | str, epoch: int) -> tuple[SurveyedPositions, tuple[str, ...]]:
    """Read a file of own ship's positions; return them and a sentence for each line left out.

    Parameters and errors are those of :func:`read_contact_lines`.
    """
    table = read_number_table(path, ("east_m", "north_m"), (*TIMES, "heading_deg"))
    bad = list(table.bad)
    rows = _positioned(table, epoch, bad)
    return _surveyed(table, epoch, rows), tuple(bad)


def read_true_positions(
    path: Path | str, epoch: int
) -> tuple[dict[int, SurveyedPositions], tuple[str, ...]]:
    """Read a file of true positions; targets are numbered from 1 in the order of the file.

    Parameters and errors are those of :func:`read_contact_lines`.
    """
    table = read_number_table(path, ("target", "east_m", "north_m"), TIMES, names=("target",))
    bad = list(table.bad)
    rows = _positioned(table, epoch, bad)
    names = np.array(table.names["target"])
    numbered = {name: number for number, name in enumerate(dict.fromkeys(names[rows]), start=1)}
    return {
        number: _surveyed(table, epoch, rows[names[rows] == name])
        for name, number in numbered.items()
    }, tuple(bad)


def _one_of(table: NumberTable, names: tuple[str, ...]) -> str:
    found = [name for name in names if name in table.numbers]
    if len(found) != 1:
        raise ConfigurationError(
            f"The file {table.path} has {' and '.join(found) or 'none'} of the columns "
            f"{', '.join(names)}; give exactly one."
        )
    return found[0]


def _stamps(table: NumberTable, epoch: int) -> IntArray:
    """Return stamps, ns; -1 where the time is not usable."""
    name = _one_of(table, TIMES)
    times = table.column(name)
    usable = np.isfinite(times) & (np.abs(times) < 9e9)
    stamp = np.rint(np.where(usable, times, 0.0) * NANOSECONDS).astype(np.int64)
    stamp += epoch if name == "time_s" else 0
    return np.where(usable & (stamp > 0), stamp, -1)


def _usable(
    table: NumberTable,
    stamp: IntArray,
    direction: str,
    amplitude: FloatArray | None,
    bad: list[str],
) -> BoolArray:
    """Return which lines can be used, and name the others with the first thing wrong."""
    distance, angle = table.column("range_m"), table.column(direction)
    contact = ~(np.isnan(distance) & np.isnan(angle))
    checks = {
        "the time is no instant after 1970": stamp > 0,
        "range_m is not a positive number": ~contact | (np.isfinite(distance) & (distance > 0.0)),
        f"{direction} is not a finite number": ~contact | np.isfinite(angle),
    }
    if amplitude is not None:
        told = np.isfinite(amplitude) & (amplitude >= 0.0)
        checks["the amplitude is not a number of at least 0"] = ~contact | told
    for name in DEVIATIONS:
        if name in table.numbers:
            values = table.column(name)
            told = np.isfinite(values) & (values > 0.0)
            checks[f"{name} is not a positive number"] = ~contact | told
    for name in OWN_SHIP:
        if name in table.numbers:
            checks[f"{name} is not a finite number"] = np.isfinite(table.column(name))
    return _named(table, checks, bad)


def _positioned(table: NumberTable, epoch: int, bad: list[str]) -> IndexArray:
    """Return the usable rows of a table of positions in order of time."""
    stamp = _stamps(table, epoch)
    checks = {"the time is no instant after 1970": stamp > 0}
    for name in ("east_m", "north_m", "heading_deg"):
        if name in table.numbers:
            checks[f"{name} is not a finite number"] = np.isfinite(table.column(name))
    rows = np.flatnonzero(_named(table, checks, bad))
    if not len(rows):
        raise ConfigurationError(f"The file {table.path} holds no usable line.")
    return rows[np.argsort(stamp[rows], kind="stable")]


def _named(table: NumberTable, checks: dict[str, BoolArray], bad: list[str]) -> BoolArray:
    good = np.ones(len(table), dtype=bool)
    for sentence, passed in checks.items():
        bad.extend(f"{table.place(int(i))}: {sentence}." for i in np.flatnonzero(good & ~passed))
        good &= passed
    return good


def _surveyed(table: NumberTable, epoch: int, rows: IndexArray) -> SurveyedPositions:
    stamp, first = np.unique(_stamps(table, epoch)[rows], return_index=True)
    rows = rows[first]
    position = np.stack([table.column("east_m"), table.column("north_m")], axis=1)[rows]
    return SurveyedPositions(
        stamp, position, azimuth_from_compass(table.column("heading_deg")[rows])
    )
