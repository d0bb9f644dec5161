"""Whether nodes that ask a discovery server find each other. No ROS."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from sonar_tracking.graph.catalogue.discovery_server import silence_in_words

PATIENCE = 5.0
"""After which a server that is asked in vain is named, s."""


class ServerWatch:
    """Names the discovery server while nodes wait for each other.

    Parameters
    ----------
    silence : callable
        Returns a sentence on the server that is asked; empty = none is.
    """

    def __init__(self, silence: Callable[[], str] = silence_in_words) -> None:
        self._silence = silence
        self._doubt = math.inf

    def begin(self, wall: float) -> None:
        """Begin to wait; wall is monotonic time, s."""
        self._doubt = wall + PATIENCE

    def end(self) -> None:
        """Wait no longer: all have been found."""
        self._doubt = math.inf

    def news(self, wall: float) -> Iterator[str]:
        """Return a sentence once if there is a server, and the wait has been long."""
        if wall > self._doubt:
            self.end()
            if silence := self._silence():
                yield f"the nodes do not find each other yet.{silence}"
