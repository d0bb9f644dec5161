"""Messages of many parts in log order, with no more parts in memory than overlap in time."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterator, Sequence

from sonar_tracking.bags.contents.storage_file import BagMessage, Part


def merged_messages(parts: Sequence[Part], topics: Collection[str]) -> Iterator[BagMessage]:
    """Yield the messages of some topics in log order; equal log times keep the order of parts.

    A part is opened when the time of its first message has come, and let go after its last.

    Parameters
    ----------
    parts : sequence of Part
        In order of recording.
    topics : collection of str
        The topics wanted.
    """
    wanted = [(part.first, place) for place, part in enumerate(parts) if part.holds(topics)]
    waiting = sorted(wanted, reverse=True)
    # Of a part one message stands in the heap at a time, so that time and place decide alone.
    heap: list[tuple[int, int, BagMessage, Iterator[BagMessage]]] = []
    while heap or waiting:
        while waiting and (not heap or waiting[-1] < heap[0][:2]):
            _, place = waiting.pop()
            _push_next(heap, place, parts[place].open(topics))
        if heap:
            _, place, message, messages = heapq.heappop(heap)
            yield message
            _push_next(heap, place, messages)


def _push_next(
    heap: list[tuple[int, int, BagMessage, Iterator[BagMessage]]],
    place: int,
    messages: Iterator[BagMessage],
) -> None:
    message = next(messages, None)
    if message is not None:
        heapq.heappush(heap, (message.log_time, place, message, messages))
