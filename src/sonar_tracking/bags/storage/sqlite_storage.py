"""One sqlite3 file of a bag, as rosbag2 of any version writes it."""

from __future__ import annotations

import sqlite3
import weakref
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

from sonar_tracking.bags.storage.bag_information import BagInformation, information_from_text
from sonar_tracking.bags.storage.message_definitions import MessageDefinition
from sonar_tracking.bags.storage.metadata import quality_from_text
from sonar_tracking.bags.storage.storage_file import (
    BagMessage,
    Part,
    StoredTopic,
    UnreadableFileError,
)


class SqliteStorage:
    """A ``.db3`` file; see :class:`sonar_tracking.bags.storage.storage_file.Storage`.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        What to call it in errors.

    Raises
    ------
    UnreadableFileError
        If it cannot be read or is no bag.
    """

    def __init__(self, path: Path, name: str) -> None:
        self._name = name
        self.damage = ""
        self.custom_data: dict[str, str] = {}
        try:
            self._connection = self._opened(path)
            weakref.finalize(self, self._connection.close)
            self.information = self._information()
            topics = self._topics()
            self._topic_names = {number: topic.name for number, topic in topics.items()}
            self.topics = list(topics.values())
            (first,) = self._connection.execute("SELECT MIN(timestamp) FROM messages").fetchone()
        except sqlite3.Error as error:
            raise UnreadableFileError(f"{name} cannot be read as a bag ({error}).") from error
        held = frozenset(topic.name for topic in self.topics if topic.message_count)
        self.parts = [Part(first, held, self._messages)] if held else []

    def _opened(self, path: Path) -> sqlite3.Connection:
        """Open the file, with what a recorder that was killed left in its journal."""
        address = path.resolve().as_uri()
        journal = path.with_name(f"{path.name}-wal")
        if journal.is_file() and journal.stat().st_size:
            try:
                return _connected(f"{address}?mode=ro")
            except sqlite3.Error:
                self.damage = f"its journal {journal.name} cannot be read where it lies"
        connection = _connected(f"{address}?immutable=1")
        (page_bytes,) = connection.execute("PRAGMA page_size").fetchone()
        if path.stat().st_size % page_bytes:
            # sqlite itself would take what is missing of the last page for zeros.
            connection.close()
            raise UnreadableFileError(
                f"{self._name} is damaged: it is cut off in the middle of a page; "
                f"sqlite3 {path.name} .recover may save the rest."
            )
        return connection

    def _information(self) -> BagInformation | None:
        if not self._columns("metadata"):
            return None
        row = self._connection.execute(
            "SELECT metadata FROM metadata ORDER BY id DESC LIMIT 1"
        ).fetchone()
        return information_from_text(str(row[0])) if row else None

    def _topics(self) -> dict[int, StoredTopic]:
        """Return the topics by number; older files say less of them."""
        wanted = ("id", "name", "type", "offered_qos_profiles", "type_description_hash")
        there = self._columns("topics")
        columns = [name if name in there else "''" for name in wanted]
        counts: dict[int, int] = dict(
            self._connection.execute("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id")
        )
        definitions = self._definitions()
        rows = self._connection.execute(f"SELECT {', '.join(columns)} FROM topics ORDER BY id")
        return {
            number: StoredTopic(
                name,
                MessageDefinition(
                    type_name, definitions.get(type_name, ("", ""))[1], type_hash,
                    definitions.get(type_name, ("", ""))[0],
                ),
                counts.get(number, 0),
                quality_from_text(quality),
            )
            for number, name, type_name, quality, type_hash in rows
        }  # fmt: skip

    def _definitions(self) -> dict[str, tuple[str, str]]:
        """Return encoding and text of the definitions by type."""
        if not self._columns("message_definitions"):
            return {}
        rows: Any = self._connection.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        )
        return {name: (encoding, text) for name, encoding, text in rows}

    def _columns(self, table: str) -> set[str]:
        return {row[1] for row in self._connection.execute(f"PRAGMA table_info({table})")}

    def _messages(self, topics: Collection[str]) -> Iterator[BagMessage]:
        numbers = [number for number, name in self._topic_names.items() if name in topics]
        listed = ", ".join(map(str, numbers))
        try:
            # Only numbers are put in order: older files have no index of times, and all data
            # would be sorted with them.
            in_order = self._connection.execute(
                f"SELECT rowid FROM messages WHERE topic_id IN ({listed}) ORDER BY timestamp, rowid"
            )
            for row in in_order:
                number, log_time, data = self._connection.execute(
                    "SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?", row
                ).fetchone()
                yield BagMessage(self._topic_names[number], log_time, bytes(data))
        except sqlite3.Error as error:
            raise UnreadableFileError(f"{self._name} is damaged ({error}).") from error


def _connected(address: str) -> sqlite3.Connection:
    """Open a file; raise :class:`sqlite3.Error` if it is no database."""
    connection = sqlite3.connect(address, uri=True)
    try:
        connection.execute("SELECT COUNT(*) FROM sqlite_master")
    except sqlite3.Error:
        connection.close()
        raise
    return connection
