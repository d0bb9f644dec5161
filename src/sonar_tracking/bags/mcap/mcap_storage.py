"""One MCAP file of a bag, as the reader sees it."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from sonar_tracking.bags.contents.bag_information import (
    RECORD_KEY,
    RECORD_NAME,
    information_from_text,
)
from sonar_tracking.bags.contents.message_definitions import MessageDefinition
from sonar_tracking.bags.contents.metadata import quality_from_text
from sonar_tracking.bags.contents.recording_information import CUSTOM_DATA_KEY
from sonar_tracking.bags.contents.storage_file import BagMessage, Part, StoredTopic
from sonar_tracking.bags.mcap.mcap_scan import MessageRun, places_of
from sonar_tracking.bags.mcap.mcap_scanner import scan_mcap


class McapStorage:
    """A scanned MCAP file; see :class:`sonar_tracking.bags.contents.storage_file.Storage`.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        What to call it in errors.

    Raises
    ------
    UnreadableFileError
        If it cannot be read or is no MCAP file.
    """

    def __init__(self, path: Path, name: str) -> None:
        self._scan = scan_mcap(path, name)
        self.damage = self._scan.damage
        self.losses = self._scan.losses
        record = self._scan.metadata.get(RECORD_NAME, {})
        self.information = information_from_text(record.get(RECORD_KEY, ""))
        self.custom_data = dict(self._scan.metadata.get(CUSTOM_DATA_KEY, {}))
        counts = dict.fromkeys(self._scan.channels, 0)
        for run in self._scan.runs:
            for channel, count in run.counts.items():
                counts[channel] += count
        self.topics = [self._topic(number, count) for number, count in counts.items()]
        self.parts = [self._part(run) for run in self._scan.runs]

    def _part(self, run: MessageRun) -> Part:
        names = frozenset(self._scan.channels[number].topic for number in run.counts)
        return Part(run.first, run.last, names, lambda topics: self._messages(run, topics))

    def _messages(self, run: MessageRun, topics: Collection[str]) -> Iterator[BagMessage]:
        names = {
            number: self._scan.channels[number].topic
            for number in run.counts
            if self._scan.channels[number].topic in topics
        }
        data, places = places_of(self._scan, run)
        for log_time, channel, start, length in places:
            if channel in names:
                yield BagMessage(names[channel], log_time, data[start : start + length])

    def _topic(self, number: int, count: int) -> StoredTopic:
        channel = self._scan.channels[number]
        schema = self._scan.schemas.get(channel.schema_id)
        definition = MessageDefinition(
            type_name=schema.name if schema else "",
            text=schema.data.decode("utf-8", "replace") if schema else "",
            type_hash=channel.metadata.get("topic_type_hash", ""),
            encoding=schema.encoding if schema else "",
        )
        quality = quality_from_text(channel.metadata.get("offered_qos_profiles", ""))
        role = channel.metadata.get("sonar_tracking.role", "")
        return StoredTopic(channel.topic, definition, count, quality, role)
