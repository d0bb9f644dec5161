"""The state of the graph as its nodes tell it: who is there, how often, and what is wrong."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from sonar_tracking.display.page.page_frames import Frame, text_frame
from sonar_tracking.errors import LONGEST_SENTENCE, shown
from sonar_tracking.records.time import NANOSECONDS

GONE = 5.0
"""A node that has not reported for so long is gone, s of the wall clock."""

STALE = 3.0
"""Without any data for so long, the data are stale, s of the wall clock."""

_AVERAGING = 10.0
"""Rates are averages over about so long, s of the wall clock."""

_LEVEL_NAMES = ("ok", "warning", "error", "stale")


@dataclass
class _Heard:
    """A topic: how many messages, when, and their data time."""

    count: int = 0
    wall: float = -math.inf
    time: float = math.nan
    rate: float = 0.0
    since: float = field(default_factory=monotonic)
    counted: int = 0
    rejected: int = 0
    reason: str = ""


@dataclass
class _Reported:
    """A node: when it last reported, and its concerns by name."""

    wall: float = -math.inf
    concerns: dict[str, tuple[int, str, dict[str, str]]] = field(default_factory=dict)


class Health:
    """Collects what is known of nodes and topics.

    Parameters
    ----------
    wall : callable
        Steady wall clock, s.
    """

    def __init__(self, wall: Callable[[], float] = monotonic) -> None:
        self._wall = wall
        self._topics: dict[str, _Heard] = {}
        self._nodes: dict[str, _Reported] = {}
        self._sentences: list[str] = []
        self.missed = 0
        self._newest = math.nan

    def heard(self, topic: str, data_time: float) -> None:
        """Take that a message of a topic has come; its data time in s."""
        heard = self._topics.setdefault(topic, _Heard())
        heard.count += 1
        heard.wall = self._wall()
        if math.isfinite(data_time):
            heard.time = data_time
            self._newest = data_time if math.isnan(self._newest) else max(self._newest, data_time)

    def rejected(self, topic: str, sentence: str) -> None:
        """Take that a message could not be shown, and why."""
        heard = self._topics.setdefault(topic, _Heard())
        heard.rejected += 1
        heard.reason = shown(sentence, LONGEST_SENTENCE)

    def clock_went_back(self) -> None:
        """Take that the data have begun anew."""
        self._newest = math.nan

    def diagnosed(self, message: Any) -> None:
        """Take what a node says of itself, a ``DiagnosticArray``."""
        wall = self._wall()
        for status in message.status:
            name, _, concern = str(status.name).partition(": ")
            level = status.level
            level = int.from_bytes(level, "little") if isinstance(level, bytes) else int(level)
            node = self._nodes.setdefault(name, _Reported())
            node.wall = wall
            values = {str(item.key): str(item.value) for item in status.values}
            node.concerns[concern] = (level, shown(status.message, LONGEST_SENTENCE), values)

    def frame(self) -> Frame:
        """Return the state as a frame."""
        wall = self._wall()
        newest = max((heard.wall for heard in self._topics.values()), default=-math.inf)
        return text_frame(
            "health",
            self._newest,
            quiet=wall - newest if math.isfinite(newest) else math.nan,
            stale=math.isfinite(newest) and wall - newest > STALE,
            missed=self.missed,
            nodes=[self._node(name, node, wall) for name, node in sorted(self._nodes.items())],
            topics=[self._topic(name, heard, wall) for name, heard in sorted(self._topics.items())],
        )

    def _node(self, name: str, node: _Reported, wall: float) -> dict[str, Any]:
        level, message = 0, ""
        for concern_level, sentence, _ in node.concerns.values():
            if concern_level > level:
                level, message = concern_level, sentence
        received = backlog = rejected = 0
        last = -math.inf
        for concern, (_, _, values) in node.concerns.items():
            if concern.startswith("input "):
                taken, done = _count(values, "received"), _count(values, "finished")
                received, backlog = received + taken, backlog + max(0, taken - done)
                rejected += _count(values, "rejected")
                last = max(last, _count(values, "last_stamp_ns") / NANOSECONDS)
        silent = wall - node.wall
        return {
            "name": name,
            "alive": silent <= GONE,
            "silent": silent,
            "level": _LEVEL_NAMES[min(level, 3)],
            "message": message,
            "received": received,
            "backlog": backlog,
            "rejected": rejected,
            "lag": self._newest - last if math.isfinite(last) else math.nan,
        }

    def _topic(self, name: str, heard: _Heard, wall: float) -> dict[str, Any]:
        elapsed = wall - heard.since
        if elapsed >= 1.0:
            rate = (heard.count - heard.counted) / elapsed
            weight = min(1.0, elapsed / _AVERAGING) if heard.counted else 1.0
            heard.rate += weight * (rate - heard.rate)
            heard.since, heard.counted = wall, heard.count
        return {
            "name": name,
            "count": heard.count,
            "rate": round(heard.rate, 2),
            "quiet": wall - heard.wall,
            "t": heard.time,
            "rejected": heard.rejected,
            "reason": heard.reason,
        }


def _count(values: Mapping[str, str], name: str) -> int:
    text = values.get(name, "")
    return int(text) if text.isdecimal() else 0
