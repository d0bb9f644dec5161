"""Past lists of tracks, now and then, for whoever looks back at how a solution was."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque

from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import nanoseconds

PERIOD = nanoseconds(5.0)
"""Between two lists that are kept, ns."""

MOST_LISTS = 2000
"""Lists kept of one topic, the newest."""


class PastTracks:
    """Keeps the lists of one topic.

    Parameters
    ----------
    seconds : float
        Data time kept.
    """

    def __init__(self, seconds: float) -> None:
        self._lists: deque[PositionTracks] = deque(maxlen=MOST_LISTS)
        self._kept = nanoseconds(seconds)

    def add(self, tracks: PositionTracks) -> None:
        """Take a list; one that comes soon after the last one kept is left out."""
        if self._lists and tracks.stamp < self._lists[-1].stamp + PERIOD:
            return
        self._lists.append(tracks)
        while self._lists[0].stamp < tracks.stamp - self._kept:
            self._lists.popleft()

    def at(self, stamp: int) -> PositionTracks | None:
        """Return the newest list not after a stamp, ns; None = none is kept."""
        place = bisect_right(self._lists, stamp, key=lambda tracks: tracks.stamp)
        return self._lists[place - 1] if place else None
