"""One file of a bag, whatever its format, as the reader sees it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from typing import Protocol

from sonar_tracking.bags.contents.bag_information import BagInformation
from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.message_definitions import MessageDefinition
from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.errors import ConfigurationError


@dataclass(frozen=True)
class BagMessage:
    """One recorded message: topic, log time (ns), serialised bytes as they were received."""

    topic: str
    log_time: int
    data: bytes


@dataclass(frozen=True)
class StoredTopic:
    """A topic as a storage file tells it; the role is empty where the file does not say it."""

    name: str
    definition: MessageDefinition
    message_count: int
    quality: OfferedQuality
    role: str = ""


@dataclass(frozen=True)
class Part:
    """Some messages that follow one another in a file.

    Attributes
    ----------
    first, last : int
        No message has an earlier or a later log time, ns.
    topics : frozenset of str
        Topics of its messages.
    open : callable
        Takes the topics wanted and gives their messages in log order; equal log times in the order
        of recording.
    """

    first: int
    last: int
    topics: frozenset[str]
    open: Callable[[Collection[str]], Iterator[BagMessage]]

    def holds(self, topics: Collection[str]) -> bool:
        """Return whether there are messages of any of these topics."""
        return any(topic in topics for topic in self.topics)


class UnreadableFileError(ConfigurationError):
    """Nothing in a file can be read; other files of the same bag may be whole."""


class Storage(Protocol):
    """One file of a bag.

    Attributes
    ----------
    topics : list of StoredTopic
        What it holds.
    information : BagInformation or None
        What it says of the whole bag.
    custom_data : dict
        Names and texts of the application that stand apart from that.
    damage : str
        Why not all of it can be read; empty where it can.
    losses : list of Loss
        Messages that were recorded and cannot be read.
    parts : list of Part
        All its messages, in order of recording.
    """

    topics: list[StoredTopic]
    information: BagInformation | None
    custom_data: dict[str, str]
    damage: str
    losses: list[Loss]
    parts: list[Part]
