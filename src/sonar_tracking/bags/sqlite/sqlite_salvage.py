"""What can be read of a sqlite3 file that sqlite itself does not read to its end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path

from sonar_tracking.bags.contents.bag_information import BagInformation, information_from_text
from sonar_tracking.bags.contents.decompression import LARGEST_MESSAGE
from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.message_definitions import MessageDefinition
from sonar_tracking.bags.contents.metadata import quality_from_text
from sonar_tracking.bags.contents.storage_file import BagMessage, Part, StoredTopic
from sonar_tracking.bags.mcap.mcap_scan import mapped_file
from sonar_tracking.bags.sqlite.sqlite_pages import Row, SqlitePages

_BLOB, _TEXT = 12, 13
_LARGEST_TIME = (1 << 63) - 1


class SqliteSalvage:
    """A damaged ``.db3`` file; see :class:`sonar_tracking.bags.contents.storage_file.Storage`.

    The rows of all pages are told apart by their shape: a message is two numbers and a blob, a
    topic and a definition are texts. Messages are numbered from 1 on, so gaps tell what is lost.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        What to call it in errors.
    reason : str
        What sqlite says of it.

    Raises
    ------
    UnreadableFileError
        If the file cannot be opened.
    """

    def __init__(self, path: Path, name: str, reason: str) -> None:
        self._pages = SqlitePages(mapped_file(path, name))
        self.custom_data: dict[str, str] = {}
        self.information: BagInformation | None = None
        self._topics: dict[int, tuple[str, ...]] = {}
        self._definitions: dict[str, tuple[str, str]] = {}
        self._rows: dict[int, tuple[int, int, int]] = {}
        for row in self._pages.rows():
            self._take(row)
        self._rows = {n: row for n, row in self._rows.items() if row[1] in self._topics}
        counts = Counter(topic for _, topic, _ in self._rows.values())
        self.topics = [self._topic(n, counts[n]) for n in sorted(self._topics)]
        lost = max(self._rows, default=0) - len(self._rows)
        self.damage = (
            f"{reason}; its pages were read one by one, and as they have no checksums, messages "
            "may be altered"
        )
        self.losses = [Loss(messages=lost)]
        times = [time for time, _, _ in self._rows.values()]
        held = frozenset(self._topics[n][0] for n in counts)
        self.parts = [Part(min(times), max(times), held, self._messages)] if times else []

    def _take(self, row: Row) -> None:
        kinds = [kind for kind, _ in row.columns]
        if not kinds or kinds[0] != 0:
            return
        if len(kinds) == 4 and max(kinds[1:3]) < _BLOB <= kinds[3] and kinds[3] % 2 == 0:
            self._take_message(row)
        elif 4 <= len(kinds) <= 6 and all(kind >= _TEXT and kind % 2 for kind in kinds[1:]):
            texts = tuple(str(value) for value in row.values()[1:])
            if texts[0].startswith("/"):
                self._topics.setdefault(row.number, texts)
            else:
                self._definitions.setdefault(texts[0], (texts[1], texts[2]))
        elif len(kinds) == 3 and kinds[1] < _BLOB and kinds[2] >= _TEXT and kinds[2] % 2:
            self.information = information_from_text(str(row.values()[2])) or self.information

    def _take_message(self, row: Row) -> None:
        _, topic, time, data = row.values()
        if not (isinstance(topic, int) and isinstance(time, int) and isinstance(data, bytes)):
            return
        if 0 <= time <= _LARGEST_TIME and len(data) <= LARGEST_MESSAGE and row.number > 0:
            self._rows.setdefault(row.number, (time, topic, row.place))

    def _topic(self, number: int, count: int) -> StoredTopic:
        name, type_name, _, *more = self._topics[number]
        encoding, text = self._definitions.get(type_name, ("", ""))
        quality, type_hash = (*more, "", "")[:2]
        definition = MessageDefinition(type_name, text, type_hash, encoding)
        return StoredTopic(name, definition, count, quality_from_text(quality))

    def _messages(self, topics: Collection[str]) -> Iterator[BagMessage]:
        in_order = sorted((time, n, *rest) for n, (time, *rest) in self._rows.items())
        for time, _, topic, place in in_order:
            name = self._topics[topic][0]
            row = self._pages.row(place) if name in topics else None
            if row is not None:
                yield BagMessage(name, time, bytes(row.values()[3]))  # type: ignore[arg-type]
