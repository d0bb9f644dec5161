"""One sqlite3 file of a bag recorded by others, read through rosbags."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator
from pathlib import Path

from sonar_tracking.bags.storage.bag_information import BagInformation
from sonar_tracking.bags.storage.message_definitions import MessageDefinition
from sonar_tracking.bags.storage.metadata import OfferedQuality
from sonar_tracking.bags.storage.storage_file import BagMessage, StoredTopic
from sonar_tracking.errors import ConfigurationError


class SqliteStorage:
    """A ``.db3`` file; see :class:`sonar_tracking.bags.storage.storage_file.Storage`.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    ConfigurationError
        If it cannot be read or is no bag.
    """

    def __init__(self, path: Path) -> None:
        from rosbags.interfaces import MessageDefinitionFormat
        from rosbags.rosbag2.errors import ReaderError
        from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

        encodings = {MessageDefinitionFormat.MSG: "ros2msg", MessageDefinitionFormat.IDL: "ros2idl"}
        self._reader = Sqlite3Reader(path)
        try:
            self._reader.open()
        except (ReaderError, sqlite3.Error, OSError) as error:
            raise ConfigurationError(f"{path} cannot be read as a bag ({error}).") from error
        self.damage = ""
        self.information: BagInformation | None = None
        self.custom_data: dict[str, str] = {}
        self.topics = [
            StoredTopic(
                connection.topic,
                MessageDefinition(
                    connection.msgtype,
                    connection.msgdef.data,
                    connection.digest,
                    encodings.get(connection.msgdef.format, ""),
                ),
                connection.msgcount,
                OfferedQuality(),
            )
            for connection in self._reader.connections
        ]

    def messages(self, topics: Collection[str]) -> Iterator[BagMessage]:
        """Yield the messages of some topics in log order."""
        wanted = [c for c in self._reader.connections if c.topic in topics]
        if not wanted:
            return
        for connection, log_time, data in self._reader.messages(wanted):
            yield BagMessage(connection.topic, log_time, bytes(data))
