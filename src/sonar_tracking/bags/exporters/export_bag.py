"""``sonar-tracking export``: tracks, truth, bearings and own ship of a bag for other programs.

``csv`` is one table, a row a track and instant, of everything; ``geojson`` and ``kml`` are charts:
one line a track that claims a target, and they need a datum. The bag is read once, in log order,
and memory does not grow with it.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TextIO

from rich.console import Console
from rich.progress import Progress

from sonar_tracking.bags.contents.topic_names import RECORDED_NAMES, TopicNames
from sonar_tracking.bags.exporters.chart_files import write_geojson, write_kml
from sonar_tracking.bags.exporters.export_rows import COLUMNS, rows_of
from sonar_tracking.bags.exporters.operator_names import operator_names
from sonar_tracking.bags.exporters.track_lines import TrackLines
from sonar_tracking.bags.storage.bag_datum import bag_datum
from sonar_tracking.bags.storage.bag_records import (
    BEARING_TRACKS_TYPE,
    POSITION_TRACKS_TYPE,
    records_in_order,
)
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.records.datum import ADVICE, Datum, datum_if_told

CHARTS = {"geojson": write_geojson, "kml": write_kml}
FORMATS = ("csv", *CHARTS)

_TYPES = (POSITION_TRACKS_TYPE, ODOMETRY_TYPE, BEARING_TRACKS_TYPE)


@dataclass
class _Told:
    """What was written, and what was left out."""

    rows: int = 0
    tracks: set[tuple[str, int]] = field(default_factory=set)
    rejected: list[str] = field(default_factory=list)


def export_bag(
    path: Path,
    file_format: str,
    output: Path | None = None,
    topics: Sequence[str] = (),
    datum: str = "",
    names: TopicNames = RECORDED_NAMES,
) -> Path:
    """Write the tracks of a bag to a file, and print what was done.

    Parameters
    ----------
    path : Path
        The bag.
    file_format : str
        One of :data:`FORMATS`.
    output : Path, optional
        The new file; the name of the bag with the ending of the format if not given.
    topics : sequence of str
        Only these; all of tracks, truth, bearings and own ship if none are given.
    datum : str
        Latitude and longitude of the origin of ``map`` as typed; that of the bag if empty.
    names : TopicNames
        How to call the recorded topics.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ConfigurationError
        If the bag cannot be read or holds nothing to export, a topic or the format is not known,
        a chart has no datum, or the file exists.
    """
    if file_format not in FORMATS:
        raise ConfigurationError(unknown_name_text("--format", file_format, FORMATS))
    typed = datum_if_told(datum)
    bag = read_bag(path).named(names)
    chosen = _chosen_topics(bag, topics, file_format)
    origin = typed or bag_datum(bag)
    if origin is None and file_format in CHARTS:
        raise ConfigurationError(
            f"{path} does not say where map lies on the Earth, which {file_format} needs: "
            f"add --datum LATITUDE,LONGITUDE; {ADVICE}."
        )
    target = output or Path(f"{path.resolve().stem}.{file_format}")
    if target.exists():
        raise ConfigurationError(f"{target} exists already; give another --output or remove it.")
    console = Console(highlight=False, soft_wrap=True)
    if bag.recovery:
        console.print(bag.recovery, markup=False)
    told = _written(bag, chosen, target, file_format, origin, console)
    console.print("\n".join(_summary(target, told, chosen, origin)), markup=False)
    return target


def _chosen_topics(bag: Bag, topics: Sequence[str], file_format: str) -> list[str]:
    """Return the topics to export, which hold messages of types that can be."""
    types = _TYPES if file_format == "csv" else _TYPES[:2]
    possible = [
        name
        for name, topic in bag.topics.items()
        if topic.type_name in types and topic.message_count
    ]
    there = ", ".join(possible) or "none"
    for name in topics:
        if name not in bag.topics:
            raise ConfigurationError(
                unknown_name_text(f"{bag.path}: topic {name}", name, bag.topics)
            )
        if name not in possible:
            raise ConfigurationError(
                f"{bag.path}: {name} ({bag.topics[name].type_name}) holds nothing that "
                f"{file_format} can show; topics that can be exported: {there}."
            )
    if not possible:
        raise ConfigurationError(
            f"{bag.path} holds nothing that {file_format} can show: no messages of "
            f"{', '.join(types)}. Its topics are {', '.join(bag.topics)}."
        )
    return list(topics) or possible


def _written(
    bag: Bag,
    topics: list[str],
    target: Path,
    file_format: str,
    datum: Datum | None,
    console: Console,
) -> _Told:
    """Write the file; none is left if it cannot be finished."""
    total = sum(bag.topics[topic].message_count for topic in topics)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(f"writing {target.name}", total=total)
        try:
            with target.open("w", encoding="utf-8", newline="") as file:
                write = _write_table if file_format == "csv" else _write_chart
                return write(bag, topics, datum, file, file_format, lambda: progress.advance(task))
        except BaseException:
            target.unlink(missing_ok=True)
            raise


def _write_table(
    bag: Bag,
    topics: list[str],
    datum: Datum | None,
    file: TextIO,
    _file_format: str,
    advance: Callable[[], None],
) -> _Told:
    told = _Told()
    names = operator_names(bag, told.rejected)
    writer = csv.DictWriter(file, COLUMNS, restval="", lineterminator="\n")
    writer.writeheader()
    for topic, record in records_in_order(bag, topics, told.rejected):
        for row in rows_of(record, datum):
            cells = {name: _cell(value) for name, value in row.values.items()}
            track = (topic, int(row.values.get("id") or 0))
            head = {"topic": topic, "role": bag.topics[topic].role, "name": names.get(track, "")}
            writer.writerow({**cells, **head})
            told.rows += 1
            told.tracks.add(track)
        advance()
    return told


def _write_chart(
    bag: Bag,
    topics: list[str],
    datum: Datum | None,
    file: TextIO,
    file_format: str,
    advance: Callable[[], None],
) -> _Told:
    told, lines = _Told(), TrackLines()
    names = operator_names(bag, told.rejected)
    for topic, record in records_in_order(bag, topics, told.rejected):
        for row in rows_of(record, datum):
            name = names.get((topic, int(row.values.get("id") or 0)), "")
            row.values.update(topic=topic, role=bag.topics[topic].role, name=name)
            told.rows += lines.add(topic, row)
        advance()
    whole = lines.finish()
    told.tracks |= whole.keys()
    CHARTS[file_format](whole, file)
    return told


def _cell(value: Any) -> Any:
    """Return what a table shows of a value: nothing of a number that is not known."""
    return "" if isinstance(value, float) and math.isnan(value) else value


def _summary(target: Path, told: _Told, topics: list[str], datum: Datum | None) -> list[str]:
    count = len(told.tracks)
    lines = [
        f"{target}: {told.rows} rows of {count} track{'' if count == 1 else 's'} in "
        f"{', '.join(topics)}."
    ]
    if datum is None:
        lines.append(
            "Without a datum there are no latitudes and longitudes; add --datum LATITUDE,LONGITUDE "
            "to have them."
        )
    if told.rejected:
        count = len(told.rejected)
        lines.append(f"{count} messages were left out, the first: {told.rejected[0]}")
    return lines
