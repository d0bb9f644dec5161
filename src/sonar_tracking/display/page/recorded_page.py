"""The page of one recording: what memory takes of it, and other parts when they are looked for."""

from __future__ import annotations

import math
import queue
import threading
from collections.abc import Iterator, Mapping
from dataclasses import fields
from itertools import chain, islice, takewhile
from typing import Any

from sonar_tracking.bags.contents.digest import decoded_message
from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.bags.contents.message_definitions import typestore_of
from sonar_tracking.bags.storage.bag_datum import bag_datum
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import seconds_of, text_frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.shown_types import COMMAND_TYPE, SHOWN_TYPES
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.records.time import nanoseconds

BATCH = 50
"""Messages between two looks of the server at its browsers."""

LARGEST_PART = 32 * 1024 * 1024
"""Bytes of frames shown at a time, an hour of a full scene: browsers take several times as much."""

LEAD = 120.0
"""Of a part that is looked for, what lies before the time asked for is shown from here on, s."""

READING, WHOLE = "reading", "whole"
READING_PART, PART, LAST_PART = "reading part", "part", "last part"
"""States of a recording: it is being read; all of it is shown; or a part, or that to its end."""

_LONGEST_MINUTES = 600.0
_MOUNTINGS = "scene_publisher"
"""Node whose recorded parameters tell where the sensors are on own ship."""

_ENDING = 10.0
"""The last message is looked for in so much of the end of a recording, s."""

Message = tuple[str, Any]


class RecordedPage:
    """The page of one recording.

    Parameters
    ----------
    bag : Bag
        The recording.
    port : int
        Of the page.
    address : str
        To listen at.

    Attributes
    ----------
    server : PageServer
        Serves the page, once it is started.

    Raises
    ------
    ConfigurationError
        If the bag holds nothing to show, or the page cannot be served.
    """

    def __init__(self, bag: Bag, port: int, address: str) -> None:
        self.bag = bag
        topics = bag.topics.values()
        self._shown = [t.name for t in topics if t.type_name in SHOWN_TYPES and t.message_count]
        if not self._shown:
            there = ", ".join(f"{topic.name} ({topic.type_name})" for topic in topics)
            raise ConfigurationError(
                f"{bag.path} holds nothing to show: its topics are {there}; record tracks, "
                "bearings or contacts, or give --remap OLD:=NEW."
            )
        self._wanted: queue.SimpleQueue[float] = queue.SimpleQueue()
        self._span = _data_span(bag, self._shown)
        self.server = PageServer(
            _configuration(bag, port, address),
            "",
            recording=READING,
            span=self._span,
            show_part=self._wanted.put,
        )
        for name in self._shown:
            self.server.feed.expect(name, bag.topics[name].type_name)

    def feed(self) -> None:
        """Hand the recording to the server, as much of it as is shown at a time."""
        self._say(self._read(0, -math.inf), WHOLE)

    def follow(self) -> None:
        """Show the parts that are looked for, until an interruption."""
        while True:
            time = self._wanted.get()
            while not self._wanted.empty():
                time = self._wanted.get()
            begin = max(time - LEAD, self._span[0])
            self.server.do(self._begin_part, begin)
            self._say(self._read(self._log_time(begin), time), LAST_PART)

    def _read(self, since: int, time: float) -> bool | None:
        """Show what was logged from a time on, ns, and what memory takes beyond a data time, s.

        A few messages at a time: browsers are served. Returns whether that was all to the end, None
        if another part was looked for meanwhile.
        """
        messages = self._messages(since)
        done = threading.Event()
        while batch := list(islice(messages, BATCH)):
            done.clear()
            self.server.do(self._take, batch, done)
            done.wait()
            if not self._wanted.empty():
                return None
            history = self.server.feed.history
            if history.bytes > LARGEST_PART and history.newest > time:
                return False
        return True

    def _take(self, batch: list[Message], done: threading.Event) -> None:
        try:
            for topic, message in batch:
                self.server.feed.take(topic, message)
        finally:
            done.set()

    def _begin_part(self, time: float) -> None:
        self.server.feed.begin_part(time)
        self._tell(READING_PART)

    def _say(self, is_complete: bool | None, complete: str) -> None:
        """Say how much is shown, unless another part comes."""
        if is_complete is not None:
            self.server.do(self._tell, complete if is_complete else PART)

    def _tell(self, state: str) -> None:
        self.server.recording = state
        self.server.feed.emit(text_frame("recording", math.nan, state=state))

    def _log_time(self, time: float) -> int:
        """Return when what happened at a data time, s, was logged, ns: both go on steadily."""
        begin, end = self._span
        first, last = self.bag.log_times
        share = (time - begin) / (end - begin) if end > begin else 0.0
        return first + int(share * (last - first))

    def _messages(self, since: int) -> Iterator[Message]:
        topics = self.bag.topics
        stores = {name: typestore_of(topics[name].definition) for name in self._shown}
        # What was commanded before a part has its effect in it.
        told = [name for name in self._shown if topics[name].type_name == COMMAND_TYPE]
        before = takewhile(lambda m: m.log_time < since, self.bag.messages(told) if told else ())
        for message in chain(before, self.bag.messages(self._shown, since)):
            name = message.topic
            try:
                yield name, decoded_message(stores[name], topics[name].type_name, message.data)
            except InputError as error:
                self.server.feed.health.rejected(name, str(error))


def _data_span(bag: Bag, shown: list[str]) -> tuple[float, float]:
    """Return the data times of the first and the last message that says one, s."""
    last = bag.log_times[1]
    first = next((stamp for m in bag.messages(shown) if (stamp := head_stamp(m.data))), 0)
    ending = bag.messages(shown, max(last - nanoseconds(_ENDING), 0))
    newest = max((head_stamp(message.data) for message in ending), default=first)
    return seconds_of(first), seconds_of(max(first, newest))


def _configuration(bag: Bag, port: int, address: str) -> PageConfiguration:
    parameters = bag.recording.node_parameters if bag.recording else {}
    given: Mapping[str, Any] = parameters.get(_MOUNTINGS, {})
    known = {field.name for field in fields(PageConfiguration)}
    datum = bag_datum(bag)
    return PageConfiguration(
        **{name: value for name, value in given.items() if name in known},
        port=port,
        address=address,
        title=bag.path.name,
        datum="" if datum is None else datum.to_text(),
        history_minutes=_LONGEST_MINUTES,
    )
