"""Recorded bearings: a CSV or npz file with one line a bearing, and where its sensors were.

=========================  =========================================================================
``time_s``                 since the epoch; or ``unix_time_s``, since 1970
``sensor``                 name of the sensor (optional where there is one only)
``bearing_deg``            compass, clockwise from north; or one of ``azimuth_deg``, anticlockwise
                           from east; ``relative_bearing_deg``, clockwise from the bow, or from
                           where a station faces; ``cone_angle_deg`` of a line array, 0 ahead along
                           its axis to 180 astern; ``arrival_angle_deg`` from its broadside,
                           positive ahead
``bearing_deviation_deg``  standard deviation (optional; else one for all)
``track``                  label of the source (optional); empty = not known: it is found out
``elevation_deg``          above the horizontal (optional), with ``elevation_deviation_deg``
``frequency_hz``           of a line heard there (optional), with ``frequency_deviation_hz``;
                           further lines of a bearing repeat its time, track and angle
=========================  =========================================================================

Stations that stay where they are: ``sensor``, ``east_m`` and ``north_m``, or ``latitude_deg`` and
``longitude_deg``, and, optional, ``up_m`` and ``heading_deg``, where they face.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.position_tables import POSITIONS, table_positions
from sonar_tracking.bags.tables.number_table import NumberTable, read_number_table
from sonar_tracking.bags.tables.table_directions import direction_angles
from sonar_tracking.bags.tables.table_times import NO_TIME, TIMES, one_of, table_stamps
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray

DIRECTIONS = (
    "bearing_deg",
    "azimuth_deg",
    "relative_bearing_deg",
    "cone_angle_deg",
    "arrival_angle_deg",
)
CONES = ("cone_angle_deg", "arrival_angle_deg")
FROM_THE_BOW = ("relative_bearing_deg", *CONES)
OPTIONAL = (
    "bearing_deviation_deg",
    "elevation_deg",
    "elevation_deviation_deg",
    "frequency_hz",
    "frequency_deviation_hz",
)
NAMES = ("sensor", "track")
BEARING_COLUMNS = (*TIMES, *DIRECTIONS, *OPTIONAL, *NAMES)

ONLY_SENSOR = "sensor"
"""Name of the sensor of a file that names none."""


@dataclass(frozen=True)
class BearingLines:
    """Usable lines of a file of bearings, in order of time.

    Attributes
    ----------
    stamp : ndarray of int, shape (n,)
        ns.
    sensor, track : ndarray of str, shape (n,)
        Names; a track may be empty.
    kind : str
        Of the angles, one of ``DIRECTIONS``.
    angle : ndarray, shape (n,)
        rad: of ``bearing_deg`` and ``azimuth_deg`` in ``map``, of ``relative_bearing_deg``
        anticlockwise from the bow, of cones from broadside, positive ahead.
    deviation, elevation, elevation_deviation : ndarray, shape (n,)
        rad; NaN = not given.
    frequency, frequency_deviation : ndarray, shape (n,)
        Hz; NaN = none, not given.
    notes : tuple of str
        What was left out and assumed.
    """

    stamp: IntArray
    sensor: IntArray
    track: IntArray
    kind: str
    angle: FloatArray
    deviation: FloatArray
    elevation: FloatArray
    elevation_deviation: FloatArray
    frequency: FloatArray
    frequency_deviation: FloatArray
    notes: tuple[str, ...]


@dataclass(frozen=True)
class StationPlace:
    """Where a station is.

    Attributes
    ----------
    position : tuple of float
        East, north, up, m.
    azimuth : float
        Of where it faces, rad; NaN = not given.
    """

    position: tuple[float, float, float]
    azimuth: float = np.nan


def read_bearing_lines(path: Path | str, epoch: int) -> BearingLines:
    """Read a file of bearings.

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
    table = read_number_table(path, (), BEARING_COLUMNS, names=NAMES, spared=OPTIONAL)
    kind = one_of(table, DIRECTIONS)
    sensor, track = (np.array(table.names.get(name, ("",) * len(table)), str) for name in NAMES)
    sensor = np.where(sensor == "", ONLY_SENSOR, sensor)
    groups = [f"{one}\n{label}" for one, label in zip(sensor, track, strict=True)]
    stamp = table_stamps(table, epoch, groups, of_sensor=True)
    good = _usable(table, kind, stamp)
    if not good.any():
        raise table.nothing_usable()
    rows = np.flatnonzero(good)
    rows = rows[np.argsort(stamp[rows], kind="stable")]
    radians = {name: np.radians(table.column(name))[rows] for name in OPTIONAL[:3]}
    return BearingLines(
        stamp=stamp[rows],
        sensor=sensor[rows],
        track=track[rows],
        kind=kind,
        angle=direction_angles(table, kind)[rows],
        deviation=radians["bearing_deviation_deg"],
        elevation=radians["elevation_deg"],
        elevation_deviation=radians["elevation_deviation_deg"],
        frequency=table.column("frequency_hz")[rows],
        frequency_deviation=table.column("frequency_deviation_hz")[rows],
        notes=tuple(table.notes.sentences()),
    )


def read_stations(
    path: Path | str, origin: MapOrigin | None = None
) -> tuple[dict[str, StationPlace], tuple[str, ...]]:
    """Read where stations are; return them by name, and what was left out.

    Parameters
    ----------
    path : Path or str
        CSV or npz.
    origin : MapOrigin, optional
        The datum; default: of this file alone.

    Raises
    ------
    ConfigurationError
        If it cannot be read, or names a station twice.
    """
    optional = ("up_m", "heading_deg")
    known = (*POSITIONS, *optional)
    table = read_number_table(path, ("sensor",), known, names=("sensor",), spared=optional)
    places: dict[str, StationPlace] = {}
    east, north = table_positions(table, origin or MapOrigin()).T
    up = np.nan_to_num(table.column("up_m"), nan=0.0)
    azimuth = azimuth_from_compass(table.column("heading_deg"))
    for index, name in enumerate(table.names["sensor"]):
        row = int(table.rows[index])
        if not (np.isfinite(east[index]) and np.isfinite(north[index])):
            table.notes.line(row, "the position is missing, or none on earth")
        elif name in places:
            raise ConfigurationError(
                f"{table.place(index)}: the station {name} is there twice; a station has one "
                "place, and what moves is own ship: give its track with --own-ship."
            )
        else:
            position = (float(east[index]), float(north[index]), float(up[index]))
            places[name] = StationPlace(position, float(azimuth[index]))
    return places, tuple(table.notes.sentences())


def _usable(table: NumberTable, kind: str, stamp: IntArray) -> BoolArray:
    """Return which lines can be used, and note the first thing wrong with the others."""
    angle = table.column(kind)
    lowest, highest = {"cone_angle_deg": (0.0, 180.0), "arrival_angle_deg": (-90.0, 90.0)}.get(
        kind, (-360.0, 360.0)
    )
    checks = {
        NO_TIME: stamp > 0,
        f"{kind} is missing": np.isfinite(angle),
        f"{kind} is not between {lowest:g} and {highest:g}": (angle >= lowest) & (angle <= highest),
        "bearing_deviation_deg is not a positive number": ~(
            table.column("bearing_deviation_deg") <= 0.0
        ),
        "elevation_deg is not between -90 and 90": ~(np.abs(table.column("elevation_deg")) > 90.0),
        "frequency_hz is not a positive number": ~(table.column("frequency_hz") <= 0.0),
    }
    return table.passing(checks)
