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
                           ``own_heading_deg``, compass; or ``own_latitude_deg`` with
                           ``own_longitude_deg``
=========================  =========================================================================

Lines of one time are one ping; an empty optional cell costs nothing but itself, and a contact that
cannot be used not its ping. Own ship may also come from a file of its own, see
:mod:`sonar_tracking.bags.positions.position_files`; without either it rests at the origin.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.position_tables import table_positions
from sonar_tracking.bags.tables.number_table import NumberTable, read_number_table
from sonar_tracking.bags.tables.table_directions import direction_angles
from sonar_tracking.bags.tables.table_times import NO_TIME, TIMES, one_of, table_stamps
from sonar_tracking.motion import azimuth_from_compass, wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray

DIRECTIONS = ("bearing_deg", "azimuth_deg", "relative_bearing_deg")
AMPLITUDES = ("amplitude", "amplitude_db")
DEVIATIONS = ("range_deviation_m", "bearing_deviation_deg")
OWN_PLANE = ("own_east_m", "own_north_m")
OWN_PLACE = ("own_latitude_deg", "own_longitude_deg")
OWN_SHIP = (*OWN_PLANE, *OWN_PLACE, "own_heading_deg")
SPARED = (*AMPLITUDES, *DEVIATIONS, *OWN_SHIP)
"""Columns of which an empty cell costs nothing but itself."""
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
        Linear power; empty = not measured, NaN = not known of this one.
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


def read_contact_lines(
    path: Path | str, epoch: int, origin: MapOrigin | None = None
) -> ContactLines:
    """Read a file of contacts.

    Parameters
    ----------
    path : Path or str
        CSV or npz.
    epoch : int
        Instant of ``time_s`` = 0, ns.
    origin : MapOrigin, optional
        The datum; default: of this file alone.

    Raises
    ------
    ConfigurationError
        If it cannot be read or holds no usable line.
    """
    table = read_number_table(path, ("range_m",), CONTACT_COLUMNS, spared=SPARED)
    stamp = table_stamps(table, epoch, of_sensor=True)
    direction = one_of(table, DIRECTIONS)
    amplitude = _amplitudes(table)
    heading = azimuth_from_compass(table.column("own_heading_deg"))
    own_ship = np.full((len(table), 3), np.nan)
    if {*OWN_PLANE, *OWN_PLACE} & table.numbers.keys():
        own_ship[:, :2] = table_positions(table, origin or MapOrigin(), OWN_PLANE, OWN_PLACE)
    own_ship[:, 2] = heading
    timed, contact = _usable(table, stamp, direction, amplitude)
    _note_empty(table, timed, contact)
    if not (timed & (contact | _silent(table, direction))).any():
        raise table.nothing_usable()
    distance = np.where(contact, table.column("range_m"), np.nan)
    order = np.flatnonzero(timed)
    order = order[np.argsort(stamp[order], kind="stable")]
    return ContactLines(
        stamp=stamp[order],
        range=distance[order],
        azimuth=wrap_angle(direction_angles(table, direction))[order],
        relative=direction == "relative_bearing_deg",
        amplitude=amplitude[order] if amplitude is not None else np.zeros(0),
        range_deviation=table.column("range_deviation_m")[order],
        azimuth_deviation=np.radians(table.column("bearing_deviation_deg"))[order],
        own_ship=own_ship[order],
        bad=table.notes.sentences(),
    )


def _amplitudes(table: NumberTable) -> FloatArray | None:
    if "amplitude_db" in table.numbers:
        with np.errstate(over="ignore"):
            return np.asarray(10.0 ** (0.1 * table.numbers["amplitude_db"]))
    return table.numbers.get("amplitude")


def _silent(table: NumberTable, direction: str) -> BoolArray:
    """Return which lines only say that there was a ping."""
    return np.isnan(table.column("range_m")) & np.isnan(table.column(direction))


def _usable(
    table: NumberTable, stamp: IntArray, direction: str, amplitude: FloatArray | None
) -> tuple[BoolArray, BoolArray]:
    """Return which lines have a time, and which a contact; name the first thing wrong."""
    distance, angle = table.column("range_m"), table.column(direction)
    contact = ~_silent(table, direction)
    timed = table.passing({NO_TIME: stamp > 0})
    missing = (
        f"range_m is missing beside {direction}; a ping that detected nothing has neither, and "
        "bearings without ranges are for import bearings"
    )
    checks = {
        missing: ~(contact & np.isnan(distance)),
        "range_m is not a positive number": ~(contact & (distance <= 0.0)),
        f"{direction} is missing beside range_m": ~(contact & np.isnan(angle)),
    }
    if amplitude is not None:
        checks["the amplitude is less than 0"] = ~(contact & (amplitude < 0.0))
    for name in DEVIATIONS:
        checks[f"{name} is not a positive number"] = ~(contact & (table.column(name) <= 0.0))
    return timed, table.passing(checks, timed) & contact


def _note_empty(table: NumberTable, timed: BoolArray, contact: BoolArray) -> None:
    """Note empty cells of optional columns, and what is done without them."""
    without = {
        "amplitude": "the contacts of its ping are associated by distance alone",
        "amplitude_db": "the contacts of its ping are associated by distance alone",
        "range_deviation_m": "--range-deviation is taken",
        "bearing_deviation_deg": "--bearing-deviation-deg is taken",
        **dict.fromkeys((*OWN_PLANE, *OWN_PLACE), "own ship is taken from the lines around"),
        "own_heading_deg": "the heading is taken from the lines around",
    }
    for name, remedy in without.items():
        if name in table.numbers:
            lines = timed if name in OWN_SHIP else timed & contact
            empty = lines & np.isnan(table.column(name))
            table.notes.lines(table.rows[empty], f"{name} is empty; {remedy}")
