"""``sonar-tracking show``: the live page on a recording, without the graph."""

from __future__ import annotations

import math
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
from sonar_tracking.display.page.page_feed import PageFeed
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.shown_types import SHOWN_TYPES
from sonar_tracking.display.page.web_browser import open_browser
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.stop_signals import stop_code

BATCH = 50
"""Messages between two looks of the server at its browsers."""

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
    bag = read_bag(path).named(names)
    shown = [t.name for t in bag.topics.values() if t.type_name in SHOWN_TYPES and t.message_count]
    if not shown:
        there = ", ".join(f"{topic.name} ({topic.type_name})" for topic in bag.topics.values())
        raise ConfigurationError(
            f"{path} holds nothing to show: its topics are {there}; record tracks, bearings or "
            "contacts, or give --remap OLD:=NEW."
        )
    server = PageServer(_configuration(bag, port, address), "", recording=_span(bag, shown))
    server.start()
    print(f"{path} is shown at {server.address} (Ctrl-C ends it)", flush=True)
    if bag.recovery:
        print(bag.recovery)
    if browser:
        open_browser(server.address)
    try:
        _feed(bag, shown, server)
        while True:
            time.sleep(1.0)
    except KeyboardInterrupt:
        return stop_code()
    finally:
        server.stop()


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


def _span(bag: Bag, shown: list[str]) -> dict[str, float]:
    """Return the first and last data time of a bag, s."""
    times = [message.log_time for message in bag.messages(shown) if message.log_time]
    if not times:
        return {"t0": math.nan, "t1": math.nan}
    return {"t0": min(times) / NANOSECONDS, "t1": max(times) / NANOSECONDS}


def _feed(bag: Bag, shown: list[str], server: PageServer) -> None:
    """Hand the recording to the server, a few messages at a time: it serves meanwhile."""
    messages = _messages(bag, shown, server.feed)
    while batch := list(islice(messages, BATCH)):
        server.do(_take, server.feed, batch)
        time.sleep(0.002)


def _take(feed: PageFeed, batch: list[Message]) -> None:
    for topic, message in batch:
        feed.take(topic, message)


def _messages(bag: Bag, shown: list[str], feed: PageFeed) -> Iterator[Message]:
    stores = {name: typestore_of(bag.topics[name].definition) for name in shown}
    for message in bag.messages(shown):
        topic = bag.topics[message.topic]
        try:
            yield message.topic, decoded_message(stores[topic.name], topic.type_name, message.data)
        except InputError as error:
            feed.health.rejected(message.topic, str(error))
