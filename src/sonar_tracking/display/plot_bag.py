"""``sonar-tracking plot``: pictures of whatever a bag holds, and the table of its tracks.

===============================  ==================================================================
``bearing_time_record.png``      beams of an array on three time scales, bearing tracks over them;
                                 one picture a further array or topic, numbered
``line_record.png``              frequency lines; one picture a further topic, numbered
``lofar_gram.png``               spectra of the beams; one picture a further topic, numbered
``stacked_dots.png``             what the solutions leave of bearings and lines
``tactical_plot.png``            position tracks, true positions or contacts
``contact_record.png``           contacts; those of further sonars have a name after it
``track_table.png``              what became of every track; as text in ``tracks.txt``
===============================  ==================================================================

Each stands beside an SVG of the same name, whose text and lines are sharp at any size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from sonar_tracking.bags.contents.topic_names import RECORDED_NAMES, TopicNames
from sonar_tracking.bags.storage.bag_datum import bag_datum
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.display.bag_contents import BagContents, bag_contents, drawn_topics
from sonar_tracking.display.bearing_time_record import Waterfall, draw_bearing_time_record
from sonar_tracking.display.contact_record import contact_record, draw_contact_record
from sonar_tracking.display.line_record import draw_line_record, line_histories
from sonar_tracking.display.lofar_gram import draw_lofar_gram
from sonar_tracking.display.page.outermost_topic import outermost_topic, station_of
from sonar_tracking.display.picture_files import picture_style
from sonar_tracking.display.stacked_dots_record import draw_stacked_dots
from sonar_tracking.display.summary_table import (
    SummaryTable,
    bearing_summary,
    draw_summary_tables,
    position_summary,
)
from sonar_tracking.display.tactical_plot import draw_tactical_plot
from sonar_tracking.display.tactical_scene import (
    TacticalScene,
    bearing_lines,
    contact_points,
    own_ship_track,
    stations_at_rest,
)
from sonar_tracking.display.track_history import TrackHistory
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.station_name import station_name

TABLE_WIDTH = 130
PLACES_FROM = 110
"""Columns of a terminal that has room for places."""


def plot_bag(
    bag: Path | str, output: Path | str, names: TopicNames = RECORDED_NAMES
) -> tuple[Path, ...]:
    """Draw what a bag holds, and print and write the table of its tracks.

    Parameters
    ----------
    bag : Path or str
        Bag with snapshots, contacts, tracks or truth.
    output : Path or str
        Directory for the pictures; made if missing.
    names : TopicNames
        How to call the recorded topics.

    Returns
    -------
    tuple of Path
        Files written.

    Raises
    ------
    ConfigurationError
        If the bag cannot be read or holds nothing to draw.
    """
    console = Console(highlight=False, soft_wrap=True)
    opened = read_bag(bag).named(names)
    if opened.recovery:
        console.print(opened.recovery)
    contents = _contents(opened, console)
    if contents.rejected:
        console.print(
            f"{len(contents.rejected)} messages were left out, the first: {contents.rejected[0]}"
        )
    begins = contents.begins()
    if not begins:
        raise ConfigurationError(
            f"{opened.path} holds neither snapshots nor contacts nor confirmed tracks; its topics "
            f"are {', '.join(opened.topics)}."
        )
    directory, start, title = Path(output), min(begins), _title(opened)
    datum = bag_datum(opened)
    directory.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    with picture_style():
        with _progress(console) as progress:
            task = progress.add_task("drawing", total=None)
            for files in _pictures(contents, start, directory, title, datum):
                written += files
                progress.update(task, description=f"drawing, {len(written) // 2} pictures")
        written += _write_tables(contents, start, directory, console, datum)
    for path in written:
        console.print(f"wrote {path}")
    return tuple(written)


def _progress(console: Console) -> Progress:
    """Return a progress bar; where there is no terminal it is not seen."""
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    return Progress(*columns, console=console, transient=True, disable=not console.is_terminal)


def _contents(bag: Bag, console: Console) -> BagContents:
    total = sum(bag.topics[topic].message_count for topic in drawn_topics(bag))
    with _progress(console) as progress:
        task = progress.add_task("reading", total=total)
        return bag_contents(bag, lambda: progress.advance(task))


def _pictures(
    contents: BagContents, start: int, directory: Path, title: str, datum: Datum | None
) -> Iterator[Sequence[Path]]:
    """Draw one picture after the other, and yield its files."""
    yield from _draw_bearings(contents, start, directory, title)
    yield from _draw_lines(contents, start, directory, title)
    yield from _draw_lofar(contents, start, directory, title)
    if contents.dots:
        path = directory / "stacked_dots.png"
        yield draw_stacked_dots(contents.dots, contents.legs, start, path, title)
    yield from _draw_places(contents, start, directory, title, datum)


def _title(bag: Bag) -> str:
    scenario = bag.recording.scenario if bag.recording else {}
    return str(scenario.get("name", "")) or bag.path.stem


def _draw_bearings(
    contents: BagContents, start: int, directory: Path, title: str
) -> Iterator[Sequence[Path]]:
    """Draw a record for every array, and for every topic of bearings that has no beams."""
    for number, (waterfall, topic) in enumerate(_records(contents)):
        tracks = contents.bearing_tracks.get(topic, ())
        truth = _truth_of(topic, tracks, contents.bearing_truth)
        scales = waterfall.finished() if waterfall else {}
        words = [title, topic, waterfall.content if waterfall else ""]
        path = directory / _numbered("bearing_time_record", number)
        heading = "  ".join(word for word in words if word)
        yield draw_bearing_time_record(scales, tracks, truth, start, path, heading)


def _records(contents: BagContents) -> list[tuple[Waterfall | None, str]]:
    """Return beams and the topic of the bearing tracks over them, of every record to draw."""
    topics = [name for name, tracks in contents.bearing_tracks.items() if tracks]
    sensors = {name: contents.bearings[name][0].sensor.sensor_id for name in topics}
    records: list[tuple[Waterfall | None, str]] = []
    for waterfall in contents.waterfalls.values():
        own = [name for name in topics if sensors[name] == waterfall.sensor_id]
        records.append((waterfall, own[0] if own else ""))
    drawn = {topic for _, topic in records}
    records += [(None, name) for name in topics if name not in drawn]
    if not records and any(contents.bearing_truth.values()):
        records.append((None, ""))
    return records


def _draw_lines(
    contents: BagContents, start: int, directory: Path, title: str
) -> Iterator[Sequence[Path]]:
    """Draw the lines of every topic that has any."""
    number = 0
    for topic, lists in contents.frequency_lines.items():
        histories = line_histories(lists, start)
        if histories:
            path = directory / _numbered("line_record", number)
            yield draw_line_record(histories, path, f"{title}  {topic}")
            number += 1


def _draw_lofar(
    contents: BagContents, start: int, directory: Path, title: str
) -> Iterator[Sequence[Path]]:
    """Draw the gram of every topic of spectra, with the lines of the same namespace."""
    for number, (topic, rows) in enumerate(contents.grams.items()):
        lines = _near(topic, contents.frequency_lines)
        path = directory / _numbered("lofar_gram", number)
        yield draw_lofar_gram(rows.grams(start), lines, start, path, f"{title}  {topic}")


def _numbered(name: str, number: int) -> str:
    return f"{name}_{number + 1}.png" if number else f"{name}.png"


def _truth_of(
    topic: str, tracks: Sequence[TrackHistory], truths: Mapping[str, tuple[TrackHistory, ...]]
) -> tuple[TrackHistory, ...]:
    """Return the truth that belongs to a topic; none of another kind of angle."""
    truth = _near(topic, truths)
    kinds = {history.kind for history in (*tracks, *truth)}
    return truth if len(kinds) == 1 else ()


def _near(topic: str, others: Mapping[str, tuple[Any, ...]]) -> tuple[Any, ...]:
    """Return the entry of the same namespace, else the first; empty if there is none.

    The namespace of ``/bow/passive/bearing_tracks`` is ``/bow``.
    """
    namespace = topic.rsplit("/", 2)[0]
    near = [entry for name, entry in others.items() if name.rsplit("/", 2)[0] == namespace]
    return next(iter([*near, *others.values()]), ())


def _draw_places(
    contents: BagContents, start: int, directory: Path, title: str, datum: Datum | None
) -> Iterator[Sequence[Path]]:
    """Draw the chart, and the contacts as the sensor sees them."""
    truth = tuple(history for truth in contents.position_truth.values() for history in truth)
    lists = [entry for topic in contents.bearings.values() for entry in topic]
    pings = [ping for topic in contents.contacts.values() for ping in topic]
    scene = TacticalScene(
        start=start,
        own_ship=own_ship_track(contents.own_ship, start),
        truth=truth,
        tracks=contents.position_tracks,
        open_tracks=contents.open_tracks,
        other_ships={
            name: own_ship_track(states, start) for name, states in contents.other_ships.items()
        },
        contacts=contact_points(pings, start, contents.sound_speed),
        bearings=bearing_lines(lists, start),
        stations=stations_at_rest(lists),
        datum=datum,
    )
    if not scene.is_empty or contents.is_own_ship_alone:
        yield draw_tactical_plot(scene, directory / "tactical_plot.png", title)
    own = outermost_topic(contents.contacts)
    for topic, received in contents.contacts.items():
        tracks = [each for topic in contents.position_tracks.values() for each in topic]
        name = "contact_record" + ("" if topic == own else f"_{station_name(station_of(topic))}")
        record = contact_record(received, start)
        yield draw_contact_record(record, tracks, truth, directory / f"{name}.png", title)


def _write_tables(
    contents: BagContents, start: int, directory: Path, console: Console, datum: Datum | None
) -> list[Path]:
    """Print the tables of the tracks and write them as text and as a picture.

    A narrow terminal has no room for places.
    """
    tables = _tables(contents, start, datum)
    if not tables:
        return []
    printed = tables if console.width >= PLACES_FROM else _tables(contents, start, None)
    for table in printed:
        console.print(table.to_rich())
    text = directory / "tracks.txt"
    with text.open("w", encoding="utf-8") as file:
        to_file = Console(file=file, width=TABLE_WIDTH, highlight=False)
        for table in tables:
            to_file.print(table.to_rich())
    return [text, *draw_summary_tables(tables, directory / "track_table.png")]


def _tables(contents: BagContents, start: int, datum: Datum | None) -> list[SummaryTable]:
    tables: list[SummaryTable] = [
        bearing_summary(topic, tracks, start)
        for topic, tracks in contents.bearing_tracks.items()
        if tracks
    ]
    tables += [
        position_summary(topic, tracks, start, datum)
        for topic, tracks in contents.position_tracks.items()
        if tracks
    ]
    return tables
