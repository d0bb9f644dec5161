"""What a long recording holds, in bounded memory: evenly chosen entries."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Thinned(Generic[Value]):
    """Entries of a sequence of unknown length, every one of a short, every n-th of a long one.

    The last entry is always among them.

    Parameters
    ----------
    most : int
        Up to so many are all kept; of more, between half as many and so many.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._kept: list[Value] = []
        self._last: list[Value] = []
        self._step, self._count = 1, 0

    def append(self, value: Value) -> None:
        """Take the next entry."""
        if self._count % self._step == 0:
            if len(self._kept) == self._most:
                self._kept = self._kept[::2]
                self._step *= 2
            self._last = []
            if self._count % self._step == 0:
                self._kept.append(value)
            else:
                self._last = [value]
        else:
            self._last = [value]
        self._count += 1

    def __len__(self) -> int:
        """Return the number of entries kept."""
        return len(self._kept) + len(self._last)

    def __iter__(self) -> Iterator[Value]:
        """Iterate over the entries kept, in order."""
        yield from self._kept
        yield from self._last
