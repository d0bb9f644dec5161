"""What needs own ship's motion at its own instant, kept until odometry has come that far."""

from __future__ import annotations

from collections import deque
from typing import Generic, TypeVar

MOST_WAITING = 1000
"""Messages that wait for odometry; if it stays away the oldest are given up."""

Item = TypeVar("Item")


class WaitingForOwnShip(Generic[Item]):
    """Keeps items by their stamps."""

    def __init__(self) -> None:
        self._items: deque[tuple[int, Item]] = deque(maxlen=MOST_WAITING)

    def keep(self, stamp: int, item: Item) -> None:
        """Keep an item; the stamp is in ns."""
        self._items.append((stamp, item))

    def released(self, newest: int) -> list[Item]:
        """Return what waits no longer, in the order in which it came.

        Parameters
        ----------
        newest : int
            Stamp of the newest odometry, ns.
        """
        ready = [item for stamp, item in self._items if stamp <= newest]
        if ready:
            late = [entry for entry in self._items if entry[0] > newest]
            self._items = deque(late, maxlen=MOST_WAITING)
        return ready

    def clear(self) -> None:
        """Forget everything: the data begin again."""
        self._items.clear()
