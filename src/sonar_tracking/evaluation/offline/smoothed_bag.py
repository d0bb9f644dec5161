"""``sonar-tracking smooth``: the position tracks in a bag with hindsight.

The new bag holds everything the old one does, and for each topic with tracks of target motion
analysis another one, ``<topic>_smoothed``, with the same tracks at the same stamps. A bag of
bearings without positions is tracked first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.bags.contents.topic_names import RECORDED_NAMES, TopicNames
from sonar_tracking.bags.importers.contact_messages import position_tracks_cdr
from sonar_tracking.bags.storage.bag_records import (
    POSITION_TRACKS_TYPE,
    position_tracks_of,
    topics_of_type,
)
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.bags.storage.writer import BagWriter, new_bag
from sonar_tracking.configuration import from_mapping
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.offline.recorded_frames import RecordedFrames, recorded_frames
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.tma.batch.target_smoother import TargetSmootherConfiguration
from sonar_tracking.tma.targets.observation_log import ObservationLog
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from sonar_tracking.tma.tracker.track_smoothing import SmoothedTracks, smooth_tracks

SUFFIX = "_smoothed"
TRACKS = "/passive/tracks"
"""Where the tracks of a bag without positions would be."""

Progress = Callable[[int, int], None]
"""Takes the number of tracks that are done, and that of all of them."""


def smooth_bag(
    path: Path,
    output: Path | None = None,
    acceleration: float | None = None,
    systematic_deviation_deg: float | None = None,
    names: TopicNames = RECORDED_NAMES,
) -> Path:
    """Write a bag with smoothed tracks beside what was recorded, and print what was done.

    Parameters
    ----------
    path : Path
        The bag.
    output : Path, optional
        The new bag; ``<name>_smoothed`` beside the old one if not given.
    acceleration : float, optional
        Process noise of targets that go straight, m/s^2; that of the recording if not given.
    systematic_deviation_deg : float, optional
        Of errors of directions that do not average out, degrees; the smoother's default if not
        given.
    names : TopicNames
        How to call the recorded topics; the new bag has these names.

    Returns
    -------
    Path
        The new bag.

    Raises
    ------
    ConfigurationError
        If the bag cannot be read, has no bearings, no tracks or smoothed ones already, does not
        tell where its stations were, or the new one cannot be made.
    """
    console = Console(highlight=False, soft_wrap=True)
    bag = read_bag(path).named(names)
    target = _target(path, output)
    if bag.recovery:
        console.print(bag.recovery, markup=False)
    rejected: list[str] = []
    recorded = recorded_frames(bag, rejected)
    configuration = _configuration(recorded.configuration, acceleration, systematic_deviation_deg)
    pictures = _pictures(bag, recorded, rejected)
    log = ObservationLog(recorded.configuration)
    log.add_all(recorded.frames)
    _check_log(bag, recorded, log)
    smoothed = {}
    for topic, own in pictures.items():
        with _progress(topic, console) as done:
            smoothed[topic] = smooth_tracks(
                own, log.observations, recorded.configuration, configuration, done
            )
    with new_bag(target, bag.recording, bag.custom_data) as writer:
        _copy(bag, writer, smoothed, recorded.bearing_topics[0])
    done_texts = [f"{target}: {_done(topic, one)}" for topic, one in smoothed.items()]
    console.print("\n".join([*done_texts, *_remarks(log, rejected)]), markup=False)
    return target


def _target(path: Path, output: Path | None) -> Path:
    """Return the name of the new bag, which does not exist."""
    resolved = path.resolve()
    target = output or resolved.with_name(f"{resolved.stem}{SUFFIX}")
    if target.exists():
        raise ConfigurationError(f"{target} exists already; give another name or remove it.")
    return target


def _configuration(
    tracker: TmaTrackerConfiguration,
    acceleration: float | None,
    systematic_deviation_deg: float | None,
) -> TargetSmootherConfiguration:
    """Return the parameters: those given, else those of the tracker, else the defaults."""
    values: dict[str, float] = {
        "acceleration": tracker.acceleration if acceleration is None else acceleration,
        "manoeuvre_acceleration": tracker.manoeuvre_acceleration,
    }
    if systematic_deviation_deg is not None:
        values["systematic_deviation_deg"] = systematic_deviation_deg
    return from_mapping(TargetSmootherConfiguration, values, "smooth")


def _pictures(
    bag: Bag, recorded: RecordedFrames, rejected: list[str]
) -> dict[str, list[PositionTracks]]:
    """Return the pictures to smooth, by topic: recorded ones, or those that bearings give."""
    topics = [n for n in topics_of_type(bag, POSITION_TRACKS_TYPE) if bag.topics[n].role != "truth"]
    pictures = {topic: list(position_tracks_of(bag, topic, rejected)) for topic in topics}
    made = [name for name, own in pictures.items() if _any_of(own, TrackSource.SMOOTHED)]
    if made:
        raise ConfigurationError(
            f"{bag.path} has smoothed tracks already, {', '.join(made)}; "
            "smooth the bag it was made from."
        )
    found = {name: own for name, own in pictures.items() if _any_of(own, TrackSource.TMA)}
    if found:
        return found
    stage = TmaTrackerStage(recorded.configuration, len(recorded.bearing_topics))
    updates = [stage.update(frame) for frame in recorded.frames]
    tracked = [update.tracks for update in updates if update.tracks is not None]
    if not _any_of(tracked, TrackSource.TMA):
        if not recorded.n_own_ship:
            raise ConfigurationError(_nowhere(bag))
        raise ConfigurationError(
            f"{bag.path} holds no tracks of target motion analysis, and its bearings give none: "
            "no confirmed bearing track has a measurement with a variance."
        )
    return {TRACKS: tracked}


def _any_of(pictures: list[PositionTracks], source: TrackSource) -> bool:
    return any((picture.source == source).any() for picture in pictures)


def _check_log(bag: Bag, recorded: RecordedFrames, log: ObservationLog) -> None:
    """Refuse a bag in whose bearings nothing can be used."""
    if log.observations:
        return
    if not recorded.n_own_ship:
        raise ConfigurationError(_nowhere(bag))
    problem = next(iter(log.problems), "they hold no measurements")
    raise ConfigurationError(
        f"Nothing in {', '.join(recorded.bearing_topics)} of {bag.path} can be used: "
        f"{problem.rstrip('.')}."
    )


def _nowhere(bag: Bag) -> str:
    return (
        f"{bag.path} does not tell where its stations were: its bearings carry no pose, and there "
        "is no odometry of own ship. Record own_ship/odometry, too, or the pose with the data."
    )


def _copy(
    bag: Bag, writer: BagWriter, smoothed: dict[str, SmoothedTracks], bearing_topic: str
) -> None:
    """Write all messages; a smoothed picture follows the one it was made from.

    That of a bag without positions follows the bearings of its stamp.
    """
    for topic in bag.topics.values():
        writer.add_topic(topic.name, topic.type_name, topic.definition, topic.role, topic.quality)
    waiting: dict[str, dict[int, bytes]] = {}
    name_of: dict[str, str] = {}
    for topic_name, one in smoothed.items():
        leader = topic_name if topic_name in bag.topics else bearing_topic
        name_of[leader] = topic_name + SUFFIX
        waiting[leader] = {each.stamp: position_tracks_cdr(each) for each in one.pictures}
        writer.add_topic(topic_name + SUFFIX, POSITION_TRACKS_TYPE)
    for message in bag.messages():
        writer.write(message.topic, message.log_time, message.data)
        if message.topic in waiting:
            data = waiting[message.topic].pop(head_stamp(message.data), None)
            if data is not None:
                writer.write(name_of[message.topic], message.log_time, data)


@contextmanager
def _progress(topic: str, console: Console) -> Iterator[Progress]:
    from rich.progress import Progress as Bar

    with Bar(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(f"smoothing {topic}", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _done(topic: str, smoothed: SmoothedTracks) -> str:
    count = smoothed.n_tracks
    text = f"{count} track{'' if count == 1 else 's'} in {topic}{SUFFIX}"
    alone = [*smoothed.without_measurements, *smoothed.failed]
    if alone:
        numbers = ", ".join(map(str, alone))
        text += f"; without their bearings, from the list alone: {numbers}"
    return f"{text}."


def _remarks(log: ObservationLog, rejected: list[str]) -> list[str]:
    """Return what was left out, in words."""
    remarks = []
    if rejected:
        remarks.append(f"{len(rejected)} messages were left out, the first: {rejected[0]}")
    if log.problems:
        count = sum(log.problems.values())
        first = next(iter(log.problems)).rstrip(".")
        remarks.append(f"{count} measurements were left out, the first: {first}.")
    return remarks
