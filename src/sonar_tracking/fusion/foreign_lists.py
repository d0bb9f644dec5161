"""Own pictures and the lists of other ships in one order, that of their stamps.

A picture of own sensors goes out at once, since other ships wait for it as this one waits for
theirs. What is made of both waits until the lists up to its stamp are there, so that it does not
depend on who came first.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence

from sonar_tracking.fusion.fused_rows import OwnPicture
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import UNKNOWN_STAMP

CAPACITY = 2000
"""Pictures that wait for a ship that is late, before they no longer do."""


class ForeignLists:
    """What waits for one another.

    Parameters
    ----------
    topics : sequence of str
        Of the other ships.
    """

    def __init__(self, topics: Sequence[str]) -> None:
        self._topics = tuple(topics)
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._own: deque[OwnPicture] = deque()
        self._told: dict[str, deque[PositionTracks]] = {topic: deque() for topic in self._topics}
        self._watermarks = dict.fromkeys(self._topics, UNKNOWN_STAMP)

    def add_own(self, picture: OwnPicture) -> None:
        """Take a picture of own sensors, later than the one before."""
        self._own.append(picture)

    def add(self, topic: str, tracks: PositionTracks) -> None:
        """Take a list of another ship; one earlier than the last has begun again."""
        told = self._told[topic]
        if told and tracks.stamp <= told[-1].stamp:
            told.clear()
        told.append(tracks)
        self._watermarks[topic] = max(tracks.next_stamp, tracks.stamp + 1)

    def ready(
        self, awaited: Collection[str]
    ) -> Iterator[tuple[OwnPicture, Mapping[str, PositionTracks]]]:
        """Yield the pictures that wait for nothing any more, with the last list of each ship.

        Parameters
        ----------
        awaited : collection of str
            Topics that somebody may publish.
        """
        while self._own:
            stamp = self._own[0].tracks.stamp
            late = any(self._watermarks[topic] <= stamp for topic in awaited)
            if late and len(self._own) <= CAPACITY:
                return
            yield self._own.popleft(), self._until(stamp)

    def _until(self, stamp: int) -> dict[str, PositionTracks]:
        """Return the last new list of each ship up to a stamp, ns."""
        last: dict[str, PositionTracks] = {}
        for topic, told in self._told.items():
            while told and told[0].stamp <= stamp:
                last[topic] = told.popleft()
        return last
