"""``sonar-tracking plot``: pictures of whatever a bag holds, and the table of its tracks.

===============================  ==================================================================
``bearing_time_record.png``      bearing tracks or snapshots; one picture a further topic, numbered
``line_record.png``              frequency lines; one picture a further topic, numbered
``lofar_gram.png``               LOFAR rows
``tactical_plot.png``            position tracks, true positions or contacts
``contact_record.png``           contacts
``track_table.png``              what became of every track; as text in ``tracks.txt``
===============================  ==================================================================
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from sonar_tracking.bags.storage.bag_records import SNAPSHOTS_TYPE, snapshots_of, topics_of_type
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.bags.storage.topic_names import RECORDED_NAMES, TopicNames
from sonar_tracking.display.bag_contents import BagContents, bag_contents
from sonar_tracking.display.bearing_time_record import (
    MOST_LINES,
    BeamPicture,
    beam_picture,
    draw_bearing_time_record,
)
from sonar_tracking.display.contact_record import contact_record, draw_contact_record
from sonar_tracking.display.line_record import draw_line_record, line_histories
from sonar_tracking.display.lofar_gram import beam_grams, draw_lofar_gram
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

TABLE_WIDTH = 130


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
    rejected: list[str] = []
    contents = bag_contents(opened)
    picture = _picture(opened, rejected)
    rejected = [*contents.rejected, *rejected]
    if rejected:
        console.print(f"{len(rejected)} messages were left out, the first: {rejected[0]}")
    begins = contents.begins() + [int(stamp) for stamp in picture.stamps[:1]]
    if not begins:
        raise ConfigurationError(
            f"{opened.path} holds neither snapshots nor contacts nor confirmed tracks; its topics "
            f"are {', '.join(opened.topics)}."
        )
    directory, start, title = Path(output), min(begins), _title(opened)
    directory.mkdir(parents=True, exist_ok=True)
    written = _draw_bearings(contents, picture, start, directory, title)
    written += _draw_lines(contents, start, directory, title)
    written += _draw_lofar(contents, start, directory, title)
    written += _draw_places(contents, start, directory, title)
    written += _write_tables(contents, start, directory, console)
    for path in written:
        console.print(f"wrote {path}")
    return tuple(written)


def _title(bag: Bag) -> str:
    scenario = bag.recording.scenario if bag.recording else {}
    return str(scenario.get("name", "")) or bag.path.stem


def _picture(bag: Bag, rejected: list[str]) -> BeamPicture:
    """Return the picture of the first snapshot topic; without lines where there is none."""
    topics = topics_of_type(bag, SNAPSHOTS_TYPE)
    if not topics:
        return beam_picture((), 1)
    blocks_per_line = -(-bag.topics[topics[0]].message_count // MOST_LINES)
    return beam_picture(snapshots_of(bag, topics[0], rejected), blocks_per_line)


def _draw_bearings(
    contents: BagContents, picture: BeamPicture, start: int, directory: Path, title: str
) -> list[Path]:
    """Draw a record for every topic of bearings, the beamformer's picture in the first."""
    topics = [name for name, tracks in contents.bearing_tracks.items() if tracks]
    if not topics and (len(picture.stamps) or any(contents.bearing_truth.values())):
        topics = [""]
    written = []
    for number, topic in enumerate(topics):
        tracks = contents.bearing_tracks.get(topic, ())
        truth = _truth_of(topic, tracks, contents.bearing_truth)
        written.append(directory / _numbered("bearing_time_record", number))
        background = beam_picture((), 1) if number else picture
        heading = f"{title}  {topic}" if topic else title
        draw_bearing_time_record(background, tracks, truth, start, written[-1], heading)
    return written


def _draw_lines(contents: BagContents, start: int, directory: Path, title: str) -> list[Path]:
    """Draw the lines of every topic that has any."""
    written: list[Path] = []
    for topic, lists in contents.frequency_lines.items():
        histories = line_histories(lists, start)
        if histories:
            written.append(directory / _numbered("line_record", len(written)))
            draw_line_record(histories, written[-1], f"{title}  {topic}")
    return written


def _draw_lofar(contents: BagContents, start: int, directory: Path, title: str) -> list[Path]:
    """Draw the gram of every topic of LOFAR rows, with the lines of the same namespace."""
    written: list[Path] = []
    for topic, rows in contents.lofar_rows.items():
        grams = beam_grams(rows, start)
        if grams:
            lines = _near(topic, contents.frequency_lines)
            written.append(directory / _numbered("lofar_gram", len(written)))
            draw_lofar_gram(grams, lines, start, written[-1], f"{title}  {topic}")
    return written


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


def _draw_places(contents: BagContents, start: int, directory: Path, title: str) -> list[Path]:
    """Draw the chart, and the contacts as the sensor sees them."""
    truth = tuple(history for truth in contents.position_truth.values() for history in truth)
    lists = [entry for topic in contents.bearings.values() for entry in topic]
    scene = TacticalScene(
        start=start,
        own_ship=own_ship_track(contents.own_ship, start),
        truth=truth,
        tracks=contents.position_tracks,
        open_tracks=contents.open_tracks,
        contacts=contact_points(contents.contacts, start, contents.sound_speed),
        bearings=bearing_lines(lists, start),
        stations=stations_at_rest(lists),
    )
    written = []
    if not scene.is_empty:
        written.append(directory / "tactical_plot.png")
        draw_tactical_plot(scene, written[-1], title)
    if contents.contacts:
        tracks = [each for topic in contents.position_tracks.values() for each in topic]
        written.append(directory / "contact_record.png")
        record = contact_record(contents.contacts, start)
        draw_contact_record(record, tracks, truth, written[-1], title)
    return written


def _write_tables(
    contents: BagContents, start: int, directory: Path, console: Console
) -> list[Path]:
    """Print the tables of the tracks and write them as text and as a picture."""
    tables: list[SummaryTable] = [
        bearing_summary(topic, tracks, start)
        for topic, tracks in contents.bearing_tracks.items()
        if tracks
    ]
    tables += [
        position_summary(topic, tracks, start)
        for topic, tracks in contents.position_tracks.items()
        if tracks
    ]
    if not tables:
        return []
    written = [directory / "tracks.txt", directory / "track_table.png"]
    with written[0].open("w", encoding="utf-8") as file:
        to_file = Console(file=file, width=TABLE_WIDTH, highlight=False)
        for table in tables:
            console.print(table.to_rich())
            to_file.print(table.to_rich())
    draw_summary_tables(tables, written[1])
    return written
