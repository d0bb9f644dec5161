"""Reading of bags, whole or not, and of what others recorded.

Reads rosbag2 directories and single files. MCAP files are scanned from their beginning, so that a
bag without footer or ``metadata.yaml``, or one that was cut off, gives all its whole messages;
what is missing is reported in :attr:`Bag.recovery`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

from sonar_tracking.bags.storage.bag_information import (
    FILE_NAME,
    RECORD_NAME,
    WRAPPING_KEY,
    BagInformation,
    read_metadata_file,
)
from sonar_tracking.bags.storage.message_definitions import MessageDefinition
from sonar_tracking.bags.storage.metadata import OfferedQuality
from sonar_tracking.bags.storage.recording_information import (
    CUSTOM_DATA_KEY,
    RecordingInformation,
    Role,
    role_of_type,
)
from sonar_tracking.bags.storage.storage_file import BagMessage, Storage
from sonar_tracking.errors import ConfigurationError

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
    outdated : str or None
        A sentence that says why other tools cannot open the bag, whole or not; None = they can.
    """

    def __init__(
        self, path: Path, storages: list[Storage], metadata: BagInformation | None
    ) -> None:
        self.path = path
        self.recovery = _recovery(path, storages, metadata)
        self.outdated = _outdated(path, storages)
        self._storages = storages
        self.custom_data = _custom_data(storages, metadata)
        self.recording = self._recording_information()
        self.topics = self._merged_topics()

    @property
    def message_count(self) -> int:
        """Number of whole messages on all topics."""
        return sum(topic.message_count for topic in self.topics.values())

    def messages(self, topics: Collection[str] | None = None) -> Iterator[BagMessage]:
        """Yield messages in log order; equal log times keep the order of recording.

        Parameters
        ----------
        topics : collection of str, optional
            Only these topics; default: all.
        """
        wanted = self.topics.keys() if topics is None else topics
        for storage in self._storages:
            yield from storage.messages(wanted)

    def _recording_information(self) -> RecordingInformation | None:
        text = self.custom_data.get(CUSTOM_DATA_KEY)
        return None if text is None else RecordingInformation.from_json(text, str(self.path))

    def _merged_topics(self) -> dict[str, BagTopic]:
        known = self.recording.topic_roles if self.recording else {}
        merged: dict[str, BagTopic] = {}
        for storage in self._storages:
            for topic in storage.topics:
                before = merged[topic.name].message_count if topic.name in merged else 0
                type_name = topic.definition.type_name
                stored_role: Role | None = next(
                    (r for r in ("input", "output", "truth", "other") if r == topic.role), None
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
        rosbag2 directory, ``.mcap`` or ``.db3`` file.

    Raises
    ------
    ConfigurationError
        If there is no bag, nothing in it can be read, or it holds no sonar data.
    """
    path = Path(path)
    metadata = read_metadata_file(path)
    files = _storage_files(path, metadata)
    bag = Bag(path, [_opened(file) for file in files], metadata)
    if not bag.topics:
        reason = f" ({bag.recovery})" if bag.recovery else ""
        raise ConfigurationError(f"{path} holds no topics; nothing was recorded{reason}.")
    if not any(topic.type_name.startswith(_SONAR_PACKAGE) for topic in bag.topics.values()):
        there = ", ".join(f"{topic.name} ({topic.type_name})" for topic in bag.topics.values())
        raise ConfigurationError(
            f"{path} holds no sonar data: its topics are {there}; "
            "give a bag with a topic of the package sonar_tracking_msgs."
        )
    return bag


def _storage_files(path: Path, metadata: BagInformation | None) -> list[Path]:
    if not path.exists():
        raise ConfigurationError(f"{path} does not exist; give a bag directory.")
    if path.is_file():
        if path.suffix not in (".mcap", ".db3"):
            raise ConfigurationError(
                f"{path} is not a bag; give a rosbag2 directory, a .mcap or a .db3 file."
            )
        return [path]
    files = [path / name for name in metadata.file_names] if metadata else []
    files = [file for file in files if file.is_file()]
    found = files or sorted([*path.glob("*.mcap"), *path.glob("*.db3")])
    if not found:
        there = ", ".join(sorted(entry.name for entry in path.iterdir())[:5]) or "nothing"
        raise ConfigurationError(
            f"{path} is not a bag: it holds no .mcap or .db3 file, but {there}."
        )
    return found


def _opened(file: Path) -> Storage:
    if file.suffix == ".db3":
        from sonar_tracking.bags.storage.sqlite_storage import SqliteStorage

        return SqliteStorage(file)
    from sonar_tracking.bags.storage.mcap_storage import McapStorage

    return McapStorage(file)


def _recovery(path: Path, storages: list[Storage], metadata: BagInformation | None) -> str | None:
    """Return the sentence on what is missing, or None."""
    count = sum(topic.message_count for storage in storages for topic in storage.topics)
    reasons = [storage.damage for storage in storages if storage.damage]
    stated = metadata.message_count if metadata else _count_of_records(path, storages)
    source = FILE_NAME if metadata else "metadata record"
    if path.is_dir() and metadata is None:
        reasons.append(f"its {FILE_NAME} is missing or damaged")
    elif not reasons and stated is not None and stated != count:
        reasons.append(f"its {source} speaks of {stated} messages")
    if not reasons:
        return None
    of_all = f" of {stated}" if stated and stated > count else ""
    return f"{path} is not whole ({'; '.join(reasons)}); {count}{of_all} messages were recovered."


def _count_of_records(path: Path, storages: list[Storage]) -> int | None:
    """Return the number of messages the files themselves state for the whole bag, None = unknown.

    The file closed last knows of all files. A file that was never closed, or of which others were
    to follow, states no number that is final.
    """
    stated = [storage.information for storage in storages if storage.information]
    if not stated:
        return None
    last = max(stated, key=lambda information: len(information.file_names))
    alone = path.is_file() and len(last.file_names) > 1
    return None if alone else last.message_count or None


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
