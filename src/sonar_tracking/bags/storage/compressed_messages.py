"""Files whose messages are compressed one by one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import islice

from sonar_tracking.bags.contents.decompression import (
    LARGEST_MESSAGE,
    ZSTD_MAGIC,
    DamagedDataError,
    decompressed,
)
from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.storage_file import BagMessage, Part, Storage
from sonar_tracking.bags.storage.message_merge import merged_messages

_MESSAGES_ASKED = 3
"""One of them may be damaged."""


class CompressedMessages:
    """A file of compressed messages, seen as if they were not compressed.

    All of them are decompressed once at the beginning, so that what cannot be used is known before
    anything is started: a message that is damaged is left out and said in ``damage``.

    Parameters
    ----------
    storage : Storage
        The file.
    name : str
        What to call it in errors.

    Raises
    ------
    TooLargeError
        If a message would have more than :data:`LARGEST_MESSAGE` bytes.
    ConfigurationError
        If the library that decompresses them is not installed.
    """

    def __init__(self, storage: Storage, name: str) -> None:
        self._name = name
        self.information = storage.information
        self.custom_data = storage.custom_data
        damaged = self._damaged(storage)
        self.topics = [
            replace(topic, message_count=topic.message_count - damaged[topic.name])
            for topic in storage.topics
        ]
        told = [f"{count} messages of {topic} are damaged" for topic, count in damaged.items()]
        self.damage = "; ".join([*([storage.damage] if storage.damage else []), *told])
        self.losses = storage.losses + [Loss(topic, n) for topic, n in damaged.items()]
        self.parts = [self._part(part) for part in storage.parts]

    def _damaged(self, storage: Storage) -> Counter[str]:
        names = {topic.name for topic in storage.topics}
        damaged: Counter[str] = Counter()
        for message in merged_messages(storage.parts, names):
            try:
                self._whole(message)
            except DamagedDataError:
                damaged[message.topic] += 1
        return damaged

    def _part(self, part: Part) -> Part:
        def messages(topics: Collection[str]) -> Iterator[BagMessage]:
            for message in part.open(topics):
                try:
                    yield self._whole(message)
                except DamagedDataError:
                    continue

        return replace(part, open=messages)

    def _whole(self, message: BagMessage) -> BagMessage:
        what = f"A message of {message.topic} in {self._name}"
        return replace(message, data=decompressed(message.data, "zstd", LARGEST_MESSAGE, what))


def with_whole_messages(storage: Storage, name: str) -> Storage:
    """Return the file as it is, or, where its messages are compressed, as if they were not.

    A file tells it by its first messages: compressed ones begin as no serialised one does.
    """
    names = {topic.name for topic in storage.topics}
    first = islice(merged_messages(storage.parts, names), _MESSAGES_ASKED)
    if not any(message.data.startswith(ZSTD_MAGIC) for message in first):
        return storage
    return CompressedMessages(storage, name)
