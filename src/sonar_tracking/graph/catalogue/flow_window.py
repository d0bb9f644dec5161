"""How far the data may be ahead of the slowest node of a run. No ROS import.

Every report of a node and every tick of the clock stands for half a window. At full speed they cost
as much as the data themselves, unless the window is long; but what is in it has to fit into the
shared memory of its publisher. At the pace of the data there is nothing to gain: the clock waits
for the wall.
"""

from __future__ import annotations

import math
import os

SHORT_WINDOW, LONGEST_WINDOW = 4, 32
"""Most blocks between the clock and the slowest consumer."""

SEGMENT_BYTES = 400_000
"""What fits into the shared memory of a publisher that has no segment for large messages."""

_REPORT_PAUSE = 0.2

VARIABLE = "SONAR_TRACKING_FLOW_WINDOW"
"""Environment variable that holds the window of the run a node belongs to."""


def flow_window(rate: float, largest_message_bytes: int) -> int:
    """Return the window of a run, in blocks.

    Parameters
    ----------
    rate : float
        Data seconds per wall second; infinity = as fast as the graph takes it.
    largest_message_bytes : int
        Size of the largest message of the graph.
    """
    if not math.isinf(rate):
        return SHORT_WINDOW
    fitting = SEGMENT_BYTES // max(1, largest_message_bytes)
    return max(SHORT_WINDOW, min(LONGEST_WINDOW, fitting // SHORT_WINDOW * SHORT_WINDOW))


def own_flow_window() -> int:
    """Return the window of the run that this process was started for; by hand, the short one."""
    text = os.environ.get(VARIABLE, "")
    return int(text) if text.isdecimal() else SHORT_WINDOW


def own_report_pause() -> float:
    """Return the least time between what a node of this process says of itself without news, s.

    At full speed a second of data is over many times while a person reads once.
    """
    return _REPORT_PAUSE if own_flow_window() > SHORT_WINDOW else 0.0


def depth_for(window: int, depth: int) -> int:
    """Return how many messages a queue has to hold that holds ``depth`` of the short window."""
    return depth * window // SHORT_WINDOW
