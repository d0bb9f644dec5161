"""Surveyed bearings of the targets of a recording, from a table.

Columns ``time_s`` (since the first sample; or ``unix_time_s``), ``target`` (any name) and
``arrival_angle_deg`` (from broadside, positive towards increasing element x), one row a target and
instant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.bags.positions.given_files import Files, given_paths
from sonar_tracking.bags.positions.nmea_log import looks_like_nmea
from sonar_tracking.bags.tables.line_notes import LineNotes
from sonar_tracking.bags.tables.number_table import read_number_table, table_cells
from sonar_tracking.bags.tables.table_times import NO_TIME, TIMES, table_stamps
from sonar_tracking.records.arrays import FloatArray, IdArray
from sonar_tracking.records.time import seconds

ANGLE = "arrival_angle_deg"
_AGAIN = "there is a bearing of this time already; the first in the file holds"
_NO_ANGLE = f"{ANGLE} is missing, or none from broadside; it must lie between -90 and 90"


@dataclass(frozen=True)
class SurveyedBearings:
    """True bearings at one instant.

    Attributes
    ----------
    time : float
        Since the first sample, s.
    target : ndarray of uint64, shape (n_targets,)
        Numbers from 1, in the order in which the targets first appear in the file.
    angle, rate : ndarray, shape (n_targets,)
        Arrival angle, rad, and its rate by differences of the neighbouring instants, rad/s.
    """

    time: float
    target: IdArray
    angle: FloatArray
    rate: FloatArray


def holds_true_bearings(given: Files) -> bool:
    """Return whether what is given is one table with a column of arrival angles.

    Raises
    ------
    ConfigurationError
        If it is a table that cannot be read.
    """
    paths = given_paths(given)
    if len(paths) != 1 or paths[0].is_dir() or looks_like_nmea(paths[0]):
        return False
    return ANGLE in table_cells(paths[0], LineNotes(paths[0]))[0]


def read_surveyed_bearings(
    given: Files, epoch: int
) -> tuple[list[SurveyedBearings], tuple[str, ...]]:
    """Read a table of true bearings; return them, and a sentence for what was left out.

    Parameters
    ----------
    given : Path, str, or sequence of one
        CSV or npz.
    epoch : int
        Instant of the first sample, ns.

    Returns
    -------
    list of SurveyedBearings
        In order of time.
    tuple of str

    Raises
    ------
    ConfigurationError
        If it cannot be read, or no line can be used; file and lines are named.
    """
    table = read_number_table(given_paths(given)[0], (ANGLE, "target"), TIMES, names=("target",))
    stamp = table_stamps(table, epoch, table.names["target"])
    angle = table.column(ANGLE)
    good = table.passing({NO_TIME: stamp > 0, _NO_ANGLE: np.abs(angle) <= 90.0})
    if not good.any():
        raise table.nothing_usable()
    seen: set[tuple[int, str]] = set()
    rows = []
    for row in np.flatnonzero(good):
        name, instant = table.names["target"][row], int(stamp[row])
        if (instant, name) in seen:
            table.notes.line(int(table.rows[row]), _AGAIN)
            continue
        seen.add((instant, name))
        rows.append((seconds(instant - epoch), name, float(np.radians(angle[row]))))
    return _by_time(rows), tuple(table.notes.sentences())


def _by_time(rows: list[tuple[float, str, float]]) -> list[SurveyedBearings]:
    histories: dict[str, dict[float, float]] = {}
    for time, name, angle in rows:
        histories.setdefault(name, {})[time] = angle
    seen: dict[float, list[tuple[int, float, float]]] = {}
    for number, history in enumerate(histories.values(), start=1):
        times, angles = np.array(sorted(history.items())).T
        rates = np.gradient(angles, times) if len(times) > 1 else np.zeros(1)
        for time, angle, rate in zip(times, angles, rates, strict=True):
            seen.setdefault(float(time), []).append((number, angle, rate))
    return [
        SurveyedBearings(
            time,
            np.array([entry[0] for entry in entries], np.uint64),
            np.array([entry[1] for entry in entries]),
            np.array([entry[2] for entry in entries]),
        )
        for time, entries in sorted(seen.items())
    ]
