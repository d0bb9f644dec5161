"""How long the blocks of a recording are, and how large its messages."""

from __future__ import annotations

from itertools import islice

from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.graph.catalogue.topics import SAMPLES, SNAPSHOTS, Topic
from sonar_tracking.graph.orchestration.graph_plan import resolved
from sonar_tracking.records.time import NANOSECONDS


def block_seconds(bag: Bag) -> float:
    """Return the longest time between the first two blocks of a topic, s; 0 = there are none."""
    longest = 0
    for topic in (SNAPSHOTS, SAMPLES):
        stamps = [m.log_time for m in islice(bag.messages({resolved(topic)}), 2)]
        longest = max(longest, stamps[-1] - stamps[0] if stamps else 0)
    return longest / NANOSECONDS


def largest_input_bytes(bag: Bag, offered: tuple[Topic, ...]) -> int:
    """Return the size of the first message of the largest input topic."""
    largest = 0
    for topic in offered:
        message = next(iter(bag.messages({resolved(topic)})), None)
        largest = max(largest, len(message.data) if message else 0)
    return largest
