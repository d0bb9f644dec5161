"""Tables of positions: own ship, targets; in metres of ``map`` or as latitude and longitude.

Own ship has ``time_s`` or ``unix_time_s``, ``east_m``, ``north_m`` and, optional, ``heading_deg``;
true positions have ``target`` besides. ``latitude_deg`` and ``longitude_deg`` may stand in place of
the metres.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.bags.tables.number_table import NumberTable, read_number_table
from sonar_tracking.bags.tables.table_times import NO_TIME, TIMES, table_stamps
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.arrays import FloatArray, IndexArray, IntArray

PLANE = ("east_m", "north_m")
PLACE = ("latitude_deg", "longitude_deg")
POSITIONS = (*PLANE, *PLACE)

FARTHEST = 1e8
"""Largest coordinate of a position, m."""


def table_positions(
    table: NumberTable,
    origin: MapOrigin,
    plane: Sequence[str] = PLANE,
    place: Sequence[str] = PLACE,
) -> FloatArray:
    """Return the positions in ``map`` that a table gives either way.

    Parameters
    ----------
    table : NumberTable
        With the columns of one way.
    origin : MapOrigin
        The datum.
    plane, place : sequence of str
        Names of the columns in metres, and in degrees.

    Returns
    -------
    ndarray, shape (n_rows, 2)
        m; NaN where a row gives none that can be.

    Raises
    ------
    ConfigurationError
        If the table gives both ways, or only half of one.
    """
    given = [name for name in (*plane, *place) if name in table.numbers]
    if given not in (list(plane), list(place)):
        raise ConfigurationError(
            f"The file {table.path} has {' and '.join(given) or 'none'} of the columns "
            f"{', '.join((*plane, *place))}; give {' and '.join(plane)}, or {' and '.join(place)}."
        )
    values = np.stack([table.column(name) for name in given], axis=1)
    if given == list(plane):
        origin.take_plane(str(table.path))
        return np.where(np.abs(values) < FARTHEST, values, np.nan)
    latitude, longitude = values.T
    known = np.flatnonzero((np.abs(latitude) <= 90.0) & (np.abs(longitude) <= 360.0))
    positions = np.full(values.shape, np.nan)
    if len(known):
        turned = (longitude[known] + 180.0) % 360.0 - 180.0
        positions[known] = origin.positions(latitude[known], turned, str(table.path))
    return positions


def own_ship_of_table(
    path: Path | str, epoch: int, origin: MapOrigin
) -> tuple[SurveyedPositions, tuple[str, ...]]:
    """Read a table of own ship's positions; return them and a sentence for what was left out.

    Parameters
    ----------
    path : Path or str
        CSV or npz.
    epoch : int
        Instant of ``time_s`` = 0, ns.
    origin : MapOrigin
        The datum.

    Raises
    ------
    ConfigurationError
        If it cannot be read or holds no usable line.
    """
    heading = ("heading_deg",)
    table = read_number_table(path, (), (*TIMES, *POSITIONS, *heading), spared=heading)
    stamp, positions = table_stamps(table, epoch), table_positions(table, origin)
    rows = _positioned(table, stamp, positions)
    unknown = np.isnan(table.column("heading_deg")[rows])
    if "heading_deg" in table.numbers and unknown.any():
        sentence = "heading_deg is empty; the heading is taken from the lines around"
        if unknown.all():
            sentence = "heading_deg is empty; the course made good is taken"
        table.notes.lines(np.sort(table.rows[rows[unknown]]), sentence)
    return _surveyed(table, stamp, positions, rows), tuple(table.notes.sentences())


def true_positions_of_table(
    path: Path | str, epoch: int, origin: MapOrigin
) -> tuple[dict[str, SurveyedPositions], tuple[str, ...]]:
    """Read a table of true positions; return them by target, in the order of the file.

    Parameters and errors are those of :func:`own_ship_of_table`.
    """
    table = read_number_table(path, ("target",), (*POSITIONS, *TIMES), names=("target",))
    stamp = table_stamps(table, epoch, table.names["target"])
    positions = table_positions(table, origin)
    rows = _positioned(table, stamp, positions)
    names = np.array(table.names["target"])
    targets = {
        name: _surveyed(table, stamp, positions, rows[names[rows] == name])
        for name in dict.fromkeys(names[rows].tolist())
    }
    return targets, tuple(table.notes.sentences())


def _positioned(table: NumberTable, stamp: IntArray, positions: FloatArray) -> IndexArray:
    """Return the usable rows of a table of positions in order of time."""
    checks = {NO_TIME: stamp > 0}
    for index, name in enumerate(PLANE if PLANE[0] in table.numbers else PLACE):
        wrong = f"{name} is missing, or no position on earth"
        if name in PLACE:
            wrong += " (degrees, 54.18 or 54 10.8 N; not 5410.8 as in NMEA)"
        checks[wrong] = np.isfinite(positions[:, index])
    rows = np.flatnonzero(table.passing(checks))
    if not len(rows):
        raise table.nothing_usable()
    return rows[np.argsort(stamp[rows], kind="stable")]


def _surveyed(
    table: NumberTable, stamp: IntArray, positions: FloatArray, rows: IndexArray
) -> SurveyedPositions:
    _, first = np.unique(stamp[rows], return_index=True)
    again = np.delete(rows, first)
    sentence = "there is a position of this time already; the first in the file holds"
    table.notes.lines(np.sort(table.rows[again]), sentence)
    rows = rows[first]
    heading = azimuth_from_compass(table.column("heading_deg")[rows])
    return SurveyedPositions(stamp[rows], positions[rows], heading, str(table.path))
