"""What the recording of a disturbed run lacks. No ROS."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.time import NANOSECONDS

Stamps = Mapping[str, Sequence[int]]
"""Topic to the stamps of its messages, ns, in the order they were recorded."""


def recorded_stamps(folder: Path, topics: Collection[str]) -> Stamps:
    """Return the stamps of some topics in all bags below a folder, which may be cut off."""
    stamps: dict[str, list[int]] = defaultdict(list)
    for path in sorted(folder.glob("bag*"), key=lambda path: path.stat().st_mtime_ns):
        try:
            bag = read_bag(path)
        except ConfigurationError:
            continue  # nothing was written yet
        for message in bag.messages(bag.topics.keys() & topics):
            stamps[message.topic].append(head_stamp(message.data))
    return stamps


def messages_lost(
    stamps: Stamps, report: Mapping[str, Any], published: Mapping[str, Sequence[str]]
) -> int:
    """Return how many messages of nodes that were never killed the recording lacks.

    Parameters
    ----------
    stamps : mapping
        What was recorded.
    report : mapping
        Of the run, as its JSON.
    published : mapping of str to sequence of str
        Node to the topics it publishes, without those a second publisher was on.
    """
    nodes = report["nodes"]
    return sum(
        max(0, nodes[node]["messages_out"] - sum(len(stamps.get(topic, ())) for topic in topics))
        for node, topics in published.items()
        if nodes[node]["restarts"] == 0
    )


def longest_hole(stamps: Stamps) -> float:
    """Return the longest time of the data that a topic lacks in the middle, s."""
    holes = [0.0]
    for each in stamps.values():
        steps = np.diff(sorted({stamp for stamp in each if stamp}))
        if len(steps) > 1:
            # Several messages may belong to one instant, as odometry does at both ends of a block.
            holes.append(float(max(steps) - median(steps)) / NANOSECONDS)
    return max(holes)
