"""What target motion analysis takes, frame by frame, from a recording instead of from a graph."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from sonar_tracking.bags.storage.bag_records import (
    BEARING_TRACKS_TYPE,
    FREQUENCY_LINES_TYPE,
    directions_of,
    frequency_lines_of,
    own_ship_of,
    topics_of_type,
)
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.configuration import Value
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.evaluation.offline.offline_tma_chain import TRACKER
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.motion import KinematicState
from sonar_tracking.own_ship_interpolation import motion_at
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.station_view import with_pose_judged
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

SensorRecord = TypeVar("SensorRecord", BearingTracks, FrequencyLines)


@dataclass(frozen=True)
class RecordedFrames:
    """The frames of a recording.

    Attributes
    ----------
    frames : tuple of PassiveFrame
        In order of their stamps.
    configuration : TmaTrackerConfiguration
        Of the tracker of the recording; the defaults where it had none.
    bearing_topics : tuple of str
        Where the bearings are from.
    n_own_ship : int
        States of own ship in the recording.
    """

    frames: tuple[PassiveFrame, ...]
    configuration: TmaTrackerConfiguration
    bearing_topics: tuple[str, ...]
    n_own_ship: int


def recorded_frames(bag: Bag, rejected: list[str]) -> RecordedFrames:
    """Return the frames of a bag: bearings and lines of one stamp, and own ship then.

    Parameters
    ----------
    bag : Bag
        With bearing tracks.
    rejected : list of str
        Takes a sentence for each message that cannot be read.

    Raises
    ------
    ConfigurationError
        If it holds no bearing tracks.
    """
    given = _given(bag)
    configuration = stage_configuration(TmaTrackerConfiguration, given, f"{bag.path}: {TRACKER}")
    topics = _topics(bag, BEARING_TRACKS_TYPE, given.get("bearing_topics"))
    if not topics:
        raise ConfigurationError(
            f"{bag.path} holds no bearing tracks to smooth positions from; its topics are "
            f"{', '.join(bag.topics)}. Give a bag of a run with bearings, or --remap them."
        )
    own_ship = _own_ship(bag, rejected)
    stamps = [state.stamp for state in own_ship]
    bearings: dict[int, list[BearingTracks]] = {}
    lines: dict[int, list[FrequencyLines]] = {}
    for topic in topics:
        for one in directions_of(bag, topic, rejected):
            bearings.setdefault(one.stamp, []).append(one)
    for topic in _topics(bag, FREQUENCY_LINES_TYPE, given.get("line_topics")):
        for heard in frequency_lines_of(bag, topic, rejected):
            lines.setdefault(heard.stamp, []).append(heard)
    frames = []
    for stamp in sorted({*bearings, *lines}):
        motion = motion_at(own_ship, stamps, stamp)
        there = bool(own_ship)
        frames.append(
            PassiveFrame(
                stamp=stamp,
                bearings=tuple(
                    _placed(one, motion, configuration, there) for one in bearings.get(stamp, ())
                ),
                lines=tuple(
                    _placed(one, motion, configuration, there) for one in lines.get(stamp, ())
                ),
                own_ship=motion,
            )
        )
    return RecordedFrames(tuple(frames), configuration, tuple(topics), len(own_ship))


def _given(bag: Bag) -> Mapping[str, Value]:
    """Return the parameters of the tracker as they were recorded."""
    if bag.recording is None:
        return {}
    return dict(bag.recording.node_parameters.get(TRACKER, {}))


def _topics(bag: Bag, type_name: str, configured: Any) -> list[str]:
    """Return the topics of a type that the tracker listened to, or all that are no truth."""
    there = [name for name in topics_of_type(bag, type_name) if bag.topics[name].role != "truth"]
    if configured is None:
        return there
    named = [f"/{name.lstrip('/')}" for name in configured if name]
    return [name for name in named if name in there] or (there if named else [])


def _own_ship(bag: Bag, rejected: list[str]) -> list[OwnShipState]:
    states: dict[int, OwnShipState] = {}
    for topic in topics_of_type(bag, ODOMETRY_TYPE)[:1]:
        for state in own_ship_of(bag, topic, rejected):
            states[state.stamp] = state
    return [states[stamp] for stamp in sorted(states)]


def _placed(
    record: SensorRecord,
    motion: KinematicState | None,
    configuration: TmaTrackerConfiguration,
    odometry: bool,
) -> SensorRecord:
    """Return a record whose sensor is unknown if nobody has set its pose."""
    sensor, _ = with_pose_judged(record.sensor, motion, configuration, odometry)
    return record if sensor is record.sensor else replace(record, sensor=sensor)
