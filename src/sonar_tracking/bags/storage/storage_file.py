"""One file of a bag, whatever its format, as the reader sees it."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Protocol

from sonar_tracking.bags.storage.bag_information import BagInformation
from sonar_tracking.bags.storage.message_definitions import MessageDefinition
from sonar_tracking.bags.storage.metadata import OfferedQuality


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
    """

    topics: list[StoredTopic]
    information: BagInformation | None
    custom_data: dict[str, str]
    damage: str

    def messages(self, topics: Collection[str]) -> Iterator[BagMessage]:
        """Yield the messages of some topics in log order."""
        ...
