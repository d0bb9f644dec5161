"""One MCAP file of a bag, as the reader sees it."""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterator
from pathlib import Path

from sonar_tracking.bags.storage.bag_information import (
    RECORD_KEY,
    RECORD_NAME,
    information_from_text,
)
from sonar_tracking.bags.storage.mcap_scan import MessagePlace, decompressed, scan_mcap
from sonar_tracking.bags.storage.message_definitions import MessageDefinition
from sonar_tracking.bags.storage.metadata import quality_from_text
from sonar_tracking.bags.storage.recording_information import CUSTOM_DATA_KEY
from sonar_tracking.bags.storage.storage_file import BagMessage, StoredTopic

_CHUNKS_KEPT = 16


class McapStorage:
    """An MCAP file that was scanned; see :class:`sonar_tracking.bags.storage.storage_file.Storage`.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    ConfigurationError
        If it cannot be read or is no MCAP file.
    """

    def __init__(self, path: Path) -> None:
        self._scan = scan_mcap(path)
        self.damage = self._scan.damage
        record = self._scan.metadata.get(RECORD_NAME, {})
        self.information = information_from_text(record.get(RECORD_KEY, ""))
        self.custom_data = dict(self._scan.metadata.get(CUSTOM_DATA_KEY, {}))
        counts = dict.fromkeys(self._scan.channels, 0)
        for place in self._scan.places:
            counts[place.channel] += 1
        self.topics = [self._topic(number, count) for number, count in counts.items()]
        # Stable, so that messages of equal log time stay in the order of recording.
        self._places = sorted(self._scan.places, key=lambda place: place.log_time)
        self._chunk = functools.lru_cache(_CHUNKS_KEPT)(
            lambda number: decompressed(self._scan, number)
        )

    def messages(self, topics: Collection[str]) -> Iterator[BagMessage]:
        """Yield the messages of some topics in log order."""
        names = {
            number: channel.topic
            for number, channel in self._scan.channels.items()
            if channel.topic in topics
        }
        for place in self._places:
            if place.channel in names:
                yield BagMessage(names[place.channel], place.log_time, self._bytes(place))

    def _bytes(self, place: MessagePlace) -> bytes:
        data = self._scan.data if place.chunk < 0 else self._chunk(place.chunk)
        return data[place.start : place.start + place.length]

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
