"""One sqlite3 file of a bag, as rosbag2 of any version writes it."""

from __future__ import annotations

import sqlite3
import weakref
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

from sonar_tracking.bags.contents.bag_information import BagInformation, information_from_text
from sonar_tracking.bags.contents.decompression import LARGEST_MESSAGE
from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.message_definitions import MessageDefinition
from sonar_tracking.bags.contents.metadata import quality_from_text
from sonar_tracking.bags.contents.storage_file import (
    BagMessage,
    Part,
    StoredTopic,
    UnreadableFileError,
)
from sonar_tracking.bags.sqlite.sqlite_salvage import SqliteSalvage

_TABLES = ("messages", "topics", "metadata", "message_definitions")
# Without index: a damaged one would put messages out of order, or hide some.
_MESSAGES = (
    "FROM messages NOT INDEXED WHERE typeof(timestamp) = 'integer' AND timestamp >= 0 "
    "AND typeof(topic_id) = 'integer' AND typeof(data) = 'blob' "
    f"AND length(data) <= {LARGEST_MESSAGE}"
)
_ROUND = 1_000_000
_BYTES_A_ROUND = 50_000
_SMALLEST_ROUNDS = 50
"""A file is checked in so many rounds of instructions for its bytes, and no more."""

_FAILURES = (sqlite3.Error, UnicodeDecodeError)
"""The second where the text of the first quotes damaged bytes: the module cannot tell it."""


class DamagedDatabaseError(UnreadableFileError):
    """sqlite does not read a file to its end; its pages may hold messages."""


class SqliteStorage:
    """A ``.db3`` file; see :class:`sonar_tracking.bags.contents.storage_file.Storage`.

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
        self.losses: list[Loss] = []
        self.custom_data: dict[str, str] = {}
        try:
            self._connection = self._opened(path)
            weakref.finalize(self, self._connection.close)
            self._check()
            self.information = self._information()
            topics = self._topics()
            self._topic_names = {number: topic.name for number, topic in topics.items()}
            self.topics = list(topics.values())
            first, last = self._connection.execute(
                f"SELECT MIN(timestamp), MAX(timestamp) {_MESSAGES}"
            ).fetchone()
        except (*_FAILURES, MemoryError, OverflowError) as error:
            raise DamagedDatabaseError(f"{name} cannot be read as a bag ({error}).") from error
        held = frozenset(topic.name for topic in self.topics if topic.message_count)
        self.parts = [Part(first, last, held, self._messages)] if held else []

    def _opened(self, path: Path) -> sqlite3.Connection:
        """Open the file, with what a recorder that was killed left in its journal."""
        address = path.resolve().as_uri()
        journal = path.with_name(f"{path.name}-wal")
        size = path.stat().st_size
        if journal.is_file() and journal.stat().st_size:
            try:
                return _connected(f"{address}?mode=ro", size + journal.stat().st_size)
            except _FAILURES:
                self.damage = f"its journal {journal.name} cannot be read where it lies"
                self.losses = [Loss()]
        connection = _connected(f"{address}?immutable=1", size)
        (page_bytes,) = connection.execute("PRAGMA page_size").fetchone()
        (pages,) = connection.execute("PRAGMA page_count").fetchone()
        if size % page_bytes or size != pages * page_bytes:
            # sqlite itself would take what is missing of the last page for zeros.
            connection.close()
            raise DamagedDatabaseError(
                f"{self._name} is damaged: it has another size than its pages."
            )
        return connection

    def _check(self) -> None:
        """Refuse what only looks like the tables of a bag, or has lost its order.

        A view or a computed column would run whatever its maker has thought of.
        """
        for name in _TABLES:
            row = self._connection.execute(
                "SELECT type, sql FROM sqlite_master WHERE lower(name) = ?", (name,)
            ).fetchone()
            hidden = self._connection.execute(f"PRAGMA table_xinfo({name})").fetchall()
            if row and (
                row[0] != "table"
                or str(row[1]).upper().startswith("CREATE VIRTUAL")
                or any(column[6] for column in hidden)
            ):
                raise UnreadableFileError(
                    f"{self._name} is no bag: its {name} is not a table that holds data, but "
                    "computes them; give a file as a recorder has written it."
                )
        (said,) = self._connection.execute("PRAGMA quick_check(1)").fetchone()
        # Indexes are not used here, and may be damaged.
        if said != "ok" and "index" not in said:
            raise DamagedDatabaseError(f"{self._name} is damaged ({' '.join(said.split())}).")
        self._connection.set_progress_handler(None, 0)

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
            self._connection.execute(f"SELECT topic_id, COUNT(*) {_MESSAGES} GROUP BY topic_id")
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
            for number, *texts in rows
            if isinstance(number, int)
            for name, type_name, quality, type_hash in [map(_text, texts)]
        }  # fmt: skip

    def _definitions(self) -> dict[str, tuple[str, str]]:
        """Return encoding and text of the definitions by type."""
        if not self._columns("message_definitions"):
            return {}
        rows: Any = self._connection.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        )
        return {_text(name): (_text(encoding), _text(text)) for name, encoding, text in rows}

    def _columns(self, table: str) -> set[str]:
        return {row[1] for row in self._connection.execute(f"PRAGMA table_info({table})")}

    def _messages(self, topics: Collection[str]) -> Iterator[BagMessage]:
        numbers = [number for number, name in self._topic_names.items() if name in topics]
        listed = ", ".join(map(str, numbers))
        try:
            # Only numbers are put in order: older files have no index of times, and all data
            # would be sorted with them.
            in_order = self._connection.execute(
                f"SELECT rowid {_MESSAGES} AND topic_id IN ({listed}) ORDER BY timestamp, rowid"
            )
            for row in in_order:
                number, log_time, data = self._connection.execute(
                    "SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?", row
                ).fetchone()
                yield BagMessage(self._topic_names[number], log_time, bytes(data))
        except _FAILURES as error:
            raise UnreadableFileError(f"{self._name} is damaged ({error}).") from error


def open_sqlite(path: Path, name: str) -> SqliteStorage | SqliteSalvage:
    """Open a file; of one that sqlite does not read to its end, what its pages hold.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        What to call it in errors.

    Raises
    ------
    UnreadableFileError
        If there is no message in it, or it is no bag.
    """
    try:
        return SqliteStorage(path, name)
    except DamagedDatabaseError as error:
        reason = str(error).removeprefix(f"{name} ").rstrip(".")
        if not path.stat().st_size:
            raise
        salvage = SqliteSalvage(path, name, f"it {reason}")
        if not salvage.parts:
            raise
        return salvage


def _text(value: object) -> str:
    return value if isinstance(value, str) else ""


def _connected(address: str, size: int) -> sqlite3.Connection:
    """Open a file of ``size`` bytes; raise :class:`sqlite3.Error` if it is no database."""
    # A bag that nobody holds any more is closed by whichever thread collects it.
    connection = sqlite3.connect(address, uri=True, check_same_thread=False)
    connection.text_factory = lambda data: data.decode("utf-8", "replace")
    rounds = iter(range(1 + size // _BYTES_A_ROUND + _SMALLEST_ROUNDS))
    connection.set_progress_handler(lambda: next(rounds, None) is None, _ROUND)
    try:
        for pragma in ("trusted_schema = OFF", "ignore_check_constraints = ON"):
            connection.execute(f"PRAGMA {pragma}")
        connection.execute("SELECT COUNT(*) FROM sqlite_master")
    except _FAILURES:
        connection.close()
        raise
    return connection
