"""Headings as people write them, brought to the names that the formats have.

``Range [m]``, ``Latitude (deg)`` and ``lat`` say what they mean; what is taken for what is told.
Where no column is called ``time_s`` or ``unix_time_s``, one called time, timestamp or date is it:
a number, or text as :mod:`sonar_tracking.bags.tables.written_times` reads it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from sonar_tracking.bags.tables.line_notes import LineNotes
from sonar_tracking.bags.tables.written_times import WrittenTimes, written_times
from sonar_tracking.errors import shown

KNOWN = frozenset((
    "time_s", "unix_time_s", "range_m", "bearing_deg", "azimuth_deg", "relative_bearing_deg",
    "cone_angle_deg", "arrival_angle_deg", "amplitude", "amplitude_db", "range_deviation_m",
    "bearing_deviation_deg", "own_east_m", "own_north_m", "own_latitude_deg", "own_longitude_deg",
    "own_heading_deg", "sensor", "track", "target", "elevation_deg", "elevation_deviation_deg",
    "frequency_hz", "frequency_deviation_hz", "east_m", "north_m", "up_m", "latitude_deg",
    "longitude_deg", "heading_deg",
))  # fmt: skip
"""The columns of all formats."""

_ALSO = {
    "lat": "latitude_deg", "latitude": "latitude_deg", "lon": "longitude_deg",
    "lng": "longitude_deg", "long": "longitude_deg", "longitude": "longitude_deg",
    "heading": "heading_deg", "hdg": "heading_deg", "true_heading": "heading_deg",
    "bearing": "bearing_deg", "true_bearing": "bearing_deg", "true_bearing_deg": "bearing_deg",
    "relative_bearing": "relative_bearing_deg", "azimuth": "azimuth_deg", "range": "range_m",
    "distance": "range_m", "distance_m": "range_m", "east": "east_m", "north": "north_m",
    "up": "up_m", "frequency": "frequency_hz", "freq": "frequency_hz", "elevation": "elevation_deg",
    "station": "sensor", "track_id": "track", "target_id": "target", "own_lat": "own_latitude_deg",
    "own_lon": "own_longitude_deg", "own_heading": "own_heading_deg", "unix_time": "unix_time_s",
}  # fmt: skip
"""Other names of columns, in units of the column they are taken for."""

_UNITS = {
    "degree": "deg", "degrees": "deg", "°": "deg", "metre": "m", "metres": "m", "meter": "m",
    "meters": "m", "second": "s", "seconds": "s", "sec": "s",
}  # fmt: skip
_BETWEEN = re.compile(r"[\s\-./()\[\]{}_]+")
_CLOCKS = frozenset((
    "time", "timestamp", "datetime", "date_time", "time_utc", "utc_time", "utc", "timestamp_utc",
    "datetime_utc", "gps_time", "iso_time", "t", "time_s", "unix_time_s",
))  # fmt: skip
_DATES = frozenset(("date", "date_utc", "utc_date"))
_SINCE_1970 = 5e8
"""Seconds beyond which a number is a time since 1970."""


def canonical_columns(cells: Mapping[str, list[str]], notes: LineNotes) -> dict[str, list[str]]:
    """Return the columns by the names of the formats; what is taken for what is noted.

    Parameters
    ----------
    cells : mapping of str to list of str
        Columns by their headings.
    notes : LineNotes
        Told what is taken for what.
    """
    plain = {heading: _plain(heading) for heading in cells}
    taken: dict[str, str] = {}
    for heading, name in plain.items():
        name = _ALSO.get(name, name)
        if heading not in KNOWN and name in KNOWN and name not in {*cells, *taken.values()}:
            taken[heading] = name
    columns = {taken.get(heading, heading): list(column) for heading, column in cells.items()}
    times = _times(columns, {taken.get(h, h): name for h, name in plain.items()}, notes)
    if taken:
        told = ", ".join(f"'{shown(heading)}' for {name}" for heading, name in taken.items())
        notes.say(f"columns are taken by their headings: {told}; check the units.")
    return times


def _plain(heading: str) -> str:
    """Return a heading in small letters, with an underscore between words and the unit last."""
    words = _BETWEEN.split(heading.lower().replace("°", " ° "))
    return "_".join(_UNITS.get(word, word) for word in words if word)


def _times(
    columns: dict[str, list[str]], plain: Mapping[str, str], notes: LineNotes
) -> dict[str, list[str]]:
    """Return the columns with their times as ``time_s`` or ``unix_time_s``."""
    clock = [name for name in columns if plain[name] in _CLOCKS]
    date = [name for name in columns if plain[name] in _DATES]
    given = {"time_s", "unix_time_s"} & columns.keys()
    clock = sorted(given) or clock
    if len(clock) > 1 or len(date) > 1 or not (clock or date):
        return columns
    source = [*date, *clock] if not given else clock
    texts = [" ".join(parts) for parts in zip(*(columns[name] for name in source), strict=True)]
    found = written_times(texts)
    if found is None and len(source) > 1:
        source = clock
        found = written_times(columns[clock[0]])
    if found is None:
        return columns if given else _numbers(columns, source[0], notes)
    name = "unix_time_s" if found.is_dated else "time_s"
    kept = {n: column for n, column in columns.items() if n not in source and n != name}
    _note(source, found, notes)
    return {name: found.cells, **kept}


def _numbers(columns: dict[str, list[str]], source: str, notes: LineNotes) -> dict[str, list[str]]:
    """Return the columns with one of them as the times, if it holds numbers."""
    values = [value for cell in columns[source] if (value := number_in(cell)) is not None]
    if not values:
        return columns
    middle = sorted(values)[len(values) // 2]
    name = "unix_time_s" if middle > _SINCE_1970 else "time_s"
    notes.say(f"the column '{shown(source)}' is taken for {name}; name it so to leave no doubt.")
    return {name if n == source else n: column for n, column in columns.items()}


def number_in(cell: str) -> float | None:
    """Return the number in a cell, in the unit of its column; None = it is none."""
    try:
        return float(cell)
    except ValueError:
        return None


def _note(source: Sequence[str], found: WrittenTimes, notes: LineNotes) -> None:
    names = " and ".join(f"'{shown(name)}'" for name in source)
    if not found.is_dated:
        notes.say(
            f"{names}: times of day without a date; they count from the midnight of --epoch, "
            "give that of the day."
        )
    elif not found.has_zone:
        notes.say(f"{names}: dates and times without a zone are taken as UTC.")
