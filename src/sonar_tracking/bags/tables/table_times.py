"""Instants of the lines of a table: of which unit, in which order, over which midnight.

A log of one day counts seconds from midnight and falls back to zero there; a log in milliseconds
lies thousands of years ahead. The first is put right and told, the second is refused: what else
would it be, but who can say.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timezone

import numpy as np

from sonar_tracking.bags.tables.number_table import NumberTable
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

TIMES = ("time_s", "unix_time_s")

NO_TIME = "the time is missing, or no instant between 1970 and 2038"

DAY = 86_400.0
"""s."""

SINCE_1970 = 5e8
"""Seconds beyond which a time is one since 1970, and 16 years no recording."""

FINER = ((1e18, "nanoseconds", 1e9), (1e15, "microseconds", 1e6), (1e12, "milliseconds", 1e3))
"""Present times since 1970 in units finer than seconds, from a half of these on."""

LONG_INTERVAL = 100.0
"""Between neighbouring instants of a sensor, s: likelier a tenth of a second in milliseconds."""

UNUSABLE = -1
"""Stamp of a line without a time that can be used."""


def one_of(table: NumberTable, names: Sequence[str]) -> str:
    """Return which of some columns a table has.

    Raises
    ------
    ConfigurationError
        If that is not exactly one.
    """
    found = [name for name in names if name in table.numbers]
    if len(found) != 1:
        raise ConfigurationError(
            f"The file {table.path} has {' and '.join(found) or 'none'} of the columns "
            f"{', '.join(names)}; give exactly one."
        )
    return found[0]


def table_stamps(
    table: NumberTable, epoch: int, groups: Sequence[str] | None = None, of_sensor: bool = False
) -> IntArray:
    """Return the stamp of each line; what is odd about the times is noted.

    Parameters
    ----------
    table : NumberTable
        With one column of ``TIMES``.
    epoch : int
        Instant of ``time_s`` = 0, ns.
    groups : sequence of str, optional
        What each line belongs to; each has an order of its own. Without it all are one.
    of_sensor : bool
        Whether these are instants at which a sensor measured, which are not minutes apart.

    Returns
    -------
    ndarray of int, shape (n_rows,)
        ns; UNUSABLE where a line has no time between 1970 and 2038.

    Raises
    ------
    ConfigurationError
        If the times are of another unit or origin than their column says.
    """
    name = one_of(table, TIMES)
    times = table.column(name)
    _refuse_other_units(table, name, times)
    usable = np.isfinite(times) & (np.abs(times) < seconds_limit(name, epoch))
    labels = np.array(groups) if groups is not None else np.full(len(times), "")
    for label in dict.fromkeys(labels[usable].tolist()):
        rows = np.flatnonzero(usable & (labels == label))
        times[rows] = _in_order(table, name, times[rows], rows)
    if of_sensor:
        _note_long_intervals(table, name, times[usable])
    stamp = np.rint(np.where(usable, times, 0.0) * NANOSECONDS).astype(np.int64)
    stamp += epoch if name == "time_s" else 0
    within: BoolArray = usable & (stamp > 0) & (stamp < END_OF_DATA)
    return np.where(within, stamp, UNUSABLE)


def seconds_limit(name: str, epoch: int) -> float:
    """Return beyond what a time is none that a message can hold, s."""
    origin = epoch / NANOSECONDS if name == "time_s" else 0.0
    return END_OF_DATA / NANOSECONDS + origin


def instant_text(stamp: int) -> str:
    """Return an instant, ns, as a person writes it, in UTC."""
    instant = datetime.fromtimestamp(stamp // NANOSECONDS, timezone.utc)
    return instant.strftime("%Y-%m-%d %H:%M:%S UTC")


def _refuse_other_units(table: NumberTable, name: str, times: FloatArray) -> None:
    known = times[np.isfinite(times)]
    if not len(known):
        return
    middle = float(np.median(np.abs(known)))
    for present, unit, factor in FINER:
        if middle > 0.5 * present:
            since = middle / factor
            date = (
                instant_text(int(since) * NANOSECONDS) if since < 2**31 else "no date before 2038"
            )
            raise ConfigurationError(
                f"The file {table.path} has {name} around {middle:.6g}: these are {unit} since "
                f"1970 ({date}); divide the column by {factor:g} and name it unix_time_s."
            )
    if name == "time_s" and SINCE_1970 < middle < END_OF_DATA / NANOSECONDS:
        raise ConfigurationError(
            f"The file {table.path} has time_s around {middle:.10g}: these are seconds since 1970 "
            f"({instant_text(int(middle) * NANOSECONDS)}); name the column unix_time_s."
        )


def _in_order(table: NumberTable, name: str, times: FloatArray, rows: IntArray) -> FloatArray:
    """Return times that go on after midnight; note that, and lines out of order."""
    steps = np.diff(times)
    within_day = name == "time_s" and len(times) and times.min() >= 0.0 and times.max() <= DAY
    midnights = np.flatnonzero(steps < -0.5 * DAY) if within_day else np.zeros(0, np.intp)
    for index in midnights:
        table.notes.say(
            f"time_s falls from {times[index]:g} to {times[index + 1]:g} s at "
            f"{table.place(int(rows[index + 1])).rpartition(', ')[2]}: taken as a day that passes "
            f"midnight, {DAY:g} s are added from there on; give unix_time_s to leave no doubt."
        )
    if len(midnights):
        times = times.copy()
        times[1:] += DAY * np.cumsum(steps < -0.5 * DAY)
    early = np.flatnonzero(times < np.maximum.accumulate(times)) if len(times) else rows[:0]
    table.notes.lines(
        table.rows[rows[early]], f"{name} is less than in a line before; lines are sorted by time"
    )
    return times


def _note_long_intervals(table: NumberTable, name: str, times: FloatArray) -> None:
    instants = np.unique(times)
    if len(instants) < 3:
        return
    interval = float(np.median(np.diff(instants)))
    if interval >= LONG_INTERVAL:
        table.notes.say(
            f"the instants are {interval:g} s apart; if {name} holds milliseconds, divide it by "
            "1000."
        )
