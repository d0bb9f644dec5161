"""``sonar-tracking show``: the live page on a recording, without the graph."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import fields
from itertools import islice
from pathlib import Path
from typing import Any

from sonar_tracking.bags.storage.digest import decoded_message
from sonar_tracking.bags.storage.message_definitions import typestore_of
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.bags.storage.topic_names import TopicNames
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import text_frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.shown_types import SHOWN_TYPES
from sonar_tracking.display.page.web_browser import open_browser
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.stop_signals import stop_code

BATCH = 50
"""Messages between two looks of the server at its browsers."""

READING, WHOLE = "reading", "whole"
"""States of a recording: some of it is shown, or all."""

_LONGEST_MINUTES = 600.0
_MOUNTINGS = "scene_publisher"
"""Node whose recorded parameters tell where the sensors are on own ship."""

Message = tuple[str, Any]


def show_bag(path: Path, names: TopicNames, port: int, address: str, browser: bool) -> int:
    """Show a recording until Ctrl-C, and return the exit code of a command that was stopped.

    Parameters
    ----------
    path : Path
        The bag.
    names : TopicNames
        Names of its topics in the graph.
    port : int
        Of the page; the next free one if it is taken.
    address : str
        To listen at.
    browser : bool
        Whether to open a browser.

    Raises
    ------
    ConfigurationError
        If the bag holds nothing to show, or the page cannot be served.
    """
    page = RecordedPage(read_bag(path).named(names), port, address)
    page.server.start()
    try:
        print(f"{path} is shown at {page.server.address} (Ctrl-C ends it)", flush=True)
        if page.bag.recovery:
            print(page.bag.recovery, flush=True)
        if browser:
            open_browser(page.server.address)
        page.feed()
        while True:
            time.sleep(1.0)
    except KeyboardInterrupt:
        return stop_code()
    finally:
        page.server.stop()


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
        self.server = PageServer(_configuration(bag, port, address), "", recording=READING)

    def feed(self) -> None:
        """Hand the recording to the server, a few messages at a time: it serves meanwhile."""
        messages = self._messages()
        done = threading.Event()
        while batch := list(islice(messages, BATCH)):
            done.clear()
            self.server.do(self._take, batch, done)
            done.wait()
        self.server.do(self._whole)

    def _take(self, batch: list[Message], done: threading.Event) -> None:
        try:
            for topic, message in batch:
                self.server.feed.take(topic, message)
        finally:
            done.set()

    def _whole(self) -> None:
        self.server.recording = WHOLE
        self.server.feed.emit(text_frame("recording", math.nan, state=WHOLE))

    def _messages(self) -> Iterator[Message]:
        topics = self.bag.topics
        stores = {name: typestore_of(topics[name].definition) for name in self._shown}
        for message in self.bag.messages(self._shown):
            name = message.topic
            try:
                yield name, decoded_message(stores[name], topics[name].type_name, message.data)
            except InputError as error:
                self.server.feed.health.rejected(name, str(error))


def _configuration(bag: Bag, port: int, address: str) -> PageConfiguration:
    parameters = bag.recording.node_parameters if bag.recording else {}
    given: Mapping[str, Any] = parameters.get(_MOUNTINGS, {})
    known = {field.name for field in fields(PageConfiguration)}
    return PageConfiguration(
        **{name: value for name, value in given.items() if name in known},
        port=port,
        address=address,
        title=bag.path.name,
        history_minutes=_LONGEST_MINUTES,
    )
