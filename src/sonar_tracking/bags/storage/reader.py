"""Reading of bags, whole or not, and of what others recorded.

Reads rosbag2 directories and single files. MCAP files are scanned from their beginning, so that a
bag without footer or ``metadata.yaml``, or one that was cut off, gives all its whole messages;
what is missing is reported in :attr:`Bag.recovery`.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import get_args

from sonar_tracking.bags.contents.bag_information import (
    RECORD_NAME,
    WRAPPING_KEY,
    BagInformation,
    read_metadata_file,
)
from sonar_tracking.bags.contents.loss import MISSING_KEY, losses_from_json
from sonar_tracking.bags.contents.message_definitions import MessageDefinition
from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.contents.recording_information import (
    CUSTOM_DATA_KEY,
    RecordingInformation,
    Role,
    role_of_type,
)
from sonar_tracking.bags.contents.storage_file import BagMessage, Storage
from sonar_tracking.bags.contents.topic_names import TopicNames
from sonar_tracking.bags.storage.bag_files import files_of
from sonar_tracking.bags.storage.message_merge import merged_messages
from sonar_tracking.bags.storage.opened_files import OpenedFiles, opened_files, recovery_sentence
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.time import NANOSECONDS

_SONAR_PACKAGE = "sonar_tracking_msgs/"


@dataclass(frozen=True)
class BagTopic:
    """One topic of a bag.

    Attributes
    ----------
    name, type_name : str
        Resolved topic name and full message type.
    role : Role
        What the topic is to the chain.
    message_count : int
        Whole messages that can be read.
    definition : MessageDefinition
        As the bag carries it; empty text where it carries none.
    quality : OfferedQuality
        With which the topic was offered.
    """

    name: str
    type_name: str
    role: Role
    message_count: int
    definition: MessageDefinition
    quality: OfferedQuality


class Bag:
    """A bag that was opened; made by :func:`read_bag`.

    Attributes
    ----------
    path : Path
        What was opened.
    topics : dict
        Topic name to :class:`BagTopic`.
    custom_data : dict
        Names and texts of the applications that wrote the bag.
    recording : RecordingInformation or None
        None where the bag was recorded by something else.
    recovery : str or None
        A sentence that says what is missing and how much could be read; None = the bag is whole.
    losses : tuple of Loss
        Messages that were recorded and cannot be read; also those a repaired bag speaks of.
    outdated : str or None
        A sentence that says why other tools cannot open the bag, whole or not; None = they can.
    """

    def __init__(self, path: Path, files: OpenedFiles, metadata: BagInformation | None) -> None:
        storages = files.storages
        self.path = path
        self.outdated = _outdated(path, storages)
        self._storages = storages
        self.custom_data = _custom_data(storages, metadata)
        self.recording, unreadable = _recording_information(path, storages, metadata)
        if self.recording is None:
            self.custom_data.pop(CUSTOM_DATA_KEY, None)
        self.recovery = recovery_sentence(path, files, metadata, unreadable)
        missing = self.custom_data.get(MISSING_KEY)
        known = losses_from_json(missing) if missing is not None else []
        self.losses = (*known, *files.losses)
        self.topics = self._merged_topics()
        self._recorded_names = {name: name for name in self.topics}
        self._span: tuple[int, float] | None = None

    @property
    def message_count(self) -> int:
        """Number of whole messages on all topics."""
        return sum(topic.message_count for topic in self.topics.values())

    @property
    def log_times(self) -> tuple[int, int]:
        """First and last log time of all files, ns; (0, 0) where there is no message."""
        parts = [part for storage in self._storages for part in storage.parts]
        if not parts:
            return 0, 0
        return min(part.first for part in parts), max(part.last for part in parts)

    def messages(
        self, topics: Collection[str] | None = None, since: int = 0
    ) -> Iterator[BagMessage]:
        """Yield messages in log order; equal log times keep the order of recording.

        Files are read side by side where they overlap in time, each as far as it is needed.

        Parameters
        ----------
        topics : collection of str, optional
            Only these topics; default: all.
        since : int
            Only those with no earlier log time, ns: what lies before is not read.
        """
        wanted = self.topics.keys() if topics is None else topics
        names = {self._recorded_names.get(name, ""): name for name in wanted}
        begin, end = self._span or (0, math.inf)
        first = max(begin, since)
        parts = [p for storage in self._storages for p in storage.parts if p.last >= first]
        for message in merged_messages(parts, frozenset(names)):
            if message.log_time >= end:
                return
            if message.log_time >= first:
                name = names[message.topic]
                yield (
                    message
                    if name == message.topic
                    else BagMessage(name, message.log_time, message.data)
                )

    def named(self, names: TopicNames) -> Bag:
        """Return the bag with its topics called as in the graph.

        Raises
        ------
        ConfigurationError
            If a rule fits no topic, or two topics would have one name.
        """
        known = self.recording.topic_roles if self.recording else {}
        noted = self.recording.topic_names if self.recording else {}
        new_names = names.all_of(self.topics, str(self.path), noted)
        renamed = copy(self)
        by_recorded = {old: new_names[name] for name, old in self._recorded_names.items()}
        renamed.losses = tuple(loss.renamed(by_recorded) for loss in self.losses)
        renamed._recorded_names = {
            new_names[name]: recorded for name, recorded in self._recorded_names.items()
        }
        renamed.topics = {
            new: replace(
                topic,
                name=new,
                role=topic.role
                if new == name or name in known
                else role_of_type(new, topic.type_name),
            )
            for name, topic in self.topics.items()
            for new in [new_names[name]]
        }
        return renamed

    def part(self, offset: float, duration: float) -> Bag:
        """Return a part of the bag, counted from its first message as it was logged.

        Parameters
        ----------
        offset : float
            Where the part begins, s.
        duration : float
            How long it is, s; infinity = to the end.

        Raises
        ------
        ConfigurationError
            If nothing was recorded in that time.
        """
        begin = next((message.log_time for message in self.messages()), 0)
        first = begin + round(offset * NANOSECONDS)
        chosen = copy(self)
        chosen._span = (first, math.inf)
        if math.isfinite(duration):
            chosen._span = (first, first + round(duration * NANOSECONDS))
        counts = Counter(message.topic for message in chosen.messages())
        if not counts:
            last = max((message.log_time for message in self.messages()), default=begin)
            raise ConfigurationError(
                f"{self.path} holds no messages there (--start-offset {offset:g}, --duration "
                f"{duration:g}); it is {(last - begin) / NANOSECONDS:.1f} s long: give a smaller "
                "offset or a longer duration."
            )
        chosen.topics = {
            name: replace(topic, message_count=counts[name]) for name, topic in self.topics.items()
        }
        return chosen

    def _merged_topics(self) -> dict[str, BagTopic]:
        known = self.recording.topic_roles if self.recording else {}
        merged: dict[str, BagTopic] = {}
        for storage in self._storages:
            for topic in storage.topics:
                before = merged[topic.name].message_count if topic.name in merged else 0
                type_name = topic.definition.type_name
                stored_role: Role | None = next(
                    (r for r in get_args(Role) if r == topic.role), None
                )
                merged[topic.name] = BagTopic(
                    topic.name,
                    type_name,
                    known.get(topic.name) or stored_role or role_of_type(topic.name, type_name),
                    before + topic.message_count,
                    topic.definition,
                    topic.quality,
                )
        return dict(sorted(merged.items()))


def read_bag(path: Path | str) -> Bag:
    """Open a bag.

    Parameters
    ----------
    path : Path or str
        rosbag2 directory, ``.mcap`` or ``.db3`` file, compressed by zstd or not.

    Raises
    ------
    ConfigurationError
        If there is no bag, nothing in it can be read, or it holds no sonar data.
    """
    path = Path(path)
    metadata = read_metadata_file(path)
    files = files_of(path, metadata)
    bag = Bag(path, opened_files(files), metadata)
    if not bag.topics:
        reason = f" ({bag.recovery.rstrip('.')})" if bag.recovery else ""
        raise ConfigurationError(f"{path} holds no topics; nothing was recorded{reason}.")
    if not any(topic.type_name.startswith(_SONAR_PACKAGE) for topic in bag.topics.values()):
        there = ", ".join(f"{topic.name} ({topic.type_name})" for topic in bag.topics.values())
        raise ConfigurationError(
            f"{path} holds no sonar data: its topics are {there}; "
            "give a bag with a topic of the package sonar_tracking_msgs."
        )
    return bag


def _outdated(path: Path, storages: list[Storage]) -> str | None:
    if not any(storage.information and storage.information.wrapped for storage in storages):
        return None
    return (
        f"{path} cannot be opened by the stock ROS 2 tools: its metadata record {RECORD_NAME} "
        f"stands below {WRAPPING_KEY}, as older versions wrote it."
    )


def _custom_data(storages: list[Storage], metadata: BagInformation | None) -> dict[str, str]:
    """Return the texts of all files; what a file says apart from its bag counts most."""
    merged = dict(metadata.custom_data) if metadata else {}
    for storage in storages:
        merged |= storage.information.custom_data if storage.information else {}
        merged |= storage.custom_data
    return merged


def _recording_information(
    path: Path, storages: list[Storage], metadata: BagInformation | None
) -> tuple[RecordingInformation | None, str]:
    """Return what a bag says of its making, and in words which copies of it cannot be read."""
    stated = [storage.information for storage in storages if storage.information]
    said: list[Mapping[str, str]] = [storage.custom_data for storage in storages]
    said += [information.custom_data for information in (*stated, metadata) if information]
    texts = dict.fromkeys(copy[CUSTOM_DATA_KEY] for copy in said if CUSTOM_DATA_KEY in copy)
    unreadable = ""
    for text in texts:
        try:
            recording = RecordingInformation.from_json(text, str(path))
        except ConfigurationError as error:
            unreadable = unreadable or str(error).rstrip(".")
        else:
            return recording, unreadable and "one copy of what it says of its making is damaged"
    return None, unreadable
