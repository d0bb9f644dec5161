"""``sonar-tracking smooth``: the position tracks in a bag with hindsight.

The new bag holds everything the old one does, and for each topic with tracks of target motion
analysis another one, ``<topic>_smoothed``, with the same tracks at the same stamps.
"""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.importers.contact_messages import position_tracks_cdr
from sonar_tracking.bags.storage.bag_records import (
    POSITION_TRACKS_TYPE,
    position_tracks_of,
    topics_of_type,
)
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.bags.storage.writer import BagWriter, new_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.tma.batch.track_smoother import smooth_tracks

SUFFIX = "_smoothed"


def smooth_bag(path: Path, output: Path | None, acceleration: float) -> str:
    """Write a bag with smoothed tracks beside those recorded; return what was done, in words.

    Parameters
    ----------
    path : Path
        The bag.
    output : Path, optional
        The new bag; ``<name>_smoothed`` beside the old one if not given.
    acceleration : float
        Process noise of targets that move straight, m/s^2.

    Raises
    ------
    ConfigurationError
        If the bag cannot be read, has no such tracks, has smoothed ones already, or the new one
        cannot be made.
    """
    bag = read_bag(path)
    resolved = path.resolve()
    target = output or resolved.with_name(f"{resolved.stem}{SUFFIX}")
    remarks: list[str] = []
    smoothed = _smoothed(bag, acceleration, remarks)
    with new_bag(target, bag.recording, bag.custom_data) as writer:
        _copy(bag, writer, smoothed)
    tracks = {
        topic: len({number for picture in own for number in picture.id.tolist()})
        for topic, own in smoothed.items()
    }
    done = ", ".join(f"{count} tracks in {topic}" for topic, count in tracks.items())
    return "\n".join([f"{target}: {done}.", *remarks])


def _smoothed(
    bag: Bag, acceleration: float, remarks: list[str]
) -> dict[str, tuple[PositionTracks, ...]]:
    """Return the smoothed pictures by the name of their new topic."""
    smoothed = {}
    for topic in topics_of_type(bag, POSITION_TRACKS_TYPE):
        if bag.topics[topic].role == "truth":
            continue
        pictures = smooth_tracks(list(position_tracks_of(bag, topic, remarks)), acceleration)
        if not any(len(picture) for picture in pictures):
            continue
        if topic + SUFFIX in bag.topics:
            raise ConfigurationError(
                f"{bag.path} has {topic + SUFFIX} already; smooth the bag it was made from."
            )
        smoothed[topic + SUFFIX] = pictures
    if not smoothed:
        raise ConfigurationError(
            f"{bag.path} holds no tracks of target motion analysis; its topics are "
            f"{', '.join(bag.topics)}."
        )
    return smoothed


def _copy(bag: Bag, writer: BagWriter, smoothed: dict[str, tuple[PositionTracks, ...]]) -> None:
    """Write all messages; a smoothed picture follows the one it was made from."""
    for topic in bag.topics.values():
        writer.add_topic(topic.name, topic.type_name, topic.definition, topic.role, topic.quality)
    for name in smoothed:
        writer.add_topic(name, POSITION_TRACKS_TYPE)
    waiting = {name: iter(pictures) for name, pictures in smoothed.items()}
    for message in bag.messages():
        writer.write(message.topic, message.log_time, message.data)
        name = message.topic + SUFFIX
        if name in waiting:
            picture = next(waiting[name], None)
            if picture is not None:
                writer.write(name, message.log_time, position_tracks_cdr(picture))
