"""What targets are called that several ships tell of: one name each, whoever found them first.

A row of own sensors or of another ship's list has a name of its own. While two of them are one
target both go by the older name; the one that outlives the other keeps it, and two that prove to be
different targets each have their own again.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TypeAlias

from sonar_tracking.fusion.fusion_records import ListKey

Source: TypeAlias = int | ListKey
"""Who tells of a target: a row of own sensors, by its identifier, or one of another ship."""

OTHERS_BEGIN = 1 << 31
"""Where the names of what other ships found first begin, so that how many targets own sensors
find meanwhile does not change them."""


class SharedNames:
    """Names of the rows of a list that several ships tell of.

    Parameters
    ----------
    first_id : int
        First identifier of own ship.
    """

    def __init__(self, first_id: int) -> None:
        self._next_id = first_id + OTHERS_BEGIN
        self.forget()

    def forget(self) -> None:
        """Forget all targets; names go on."""
        self._own_name: dict[Source, int] = {}
        self._taken: dict[Source, int] = {}
        self._partner: dict[ListKey, Source] = {}

    def continue_from(self, first_id: int) -> None:
        """Let new names begin at an identifier of own ship, if those so far are below it."""
        self._next_id = max(self._next_id, first_id + OTHERS_BEGIN)

    def partner_of(self, key: ListKey) -> Source | None:
        """Return with whom a row of another ship is one target; None = with nobody."""
        return self._partner.get(key)

    def name_of(self, source: Source) -> int:
        """Return what a row is called: an older name that it shares, or its own."""
        if source in self._taken:
            return self._taken[source]
        if isinstance(source, int):
            return source
        if source not in self._own_name:
            self._own_name[source] = self._next_id
            self._next_id += 1
        return self._own_name[source]

    def own_row_called(self, name: int) -> int:
        """Return the identifier that own sensors have for a row."""
        shared = (one for one, taken in self._taken.items() if taken == name)
        return next((one for one in shared if isinstance(one, int)), name)

    def keep(self, topic: str, going_on: Collection[int]) -> None:
        """Forget the rows of another ship that it tells no more, once nobody inherits their names.

        Parameters
        ----------
        topic : str
            Of the ship.
        going_on : collection of int
            Identifiers of its rows that go on.
        """

        def has_ended(source: Source) -> bool:
            return not isinstance(source, int) and source[0] == topic and source[1] not in going_on

        for key in [one for one in self._partner if has_ended(one)]:
            del self._partner[key]
        needed = set(self._partner.values())
        for names in (self._own_name, self._taken):
            for source in [one for one in names if has_ended(one) and one not in needed]:
                del names[source]

    def keep_own(self, going_on: Collection[int]) -> None:
        """Forget the names of own rows that are no more, once nobody inherits them."""
        needed = {*going_on, *self._partner.values()}
        for source in [one for one in self._taken if isinstance(one, int) and one not in needed]:
            del self._taken[source]

    def settle(
        self, keys: Collection[ListKey], alone: Collection[ListKey], present: Collection[Source]
    ) -> None:
        """Let rows of another ship inherit names, and those that have parted give names back.

        Parameters
        ----------
        keys : collection of ListKey
            All rows of the ship.
        alone : collection of ListKey
            Those of no target known before.
        present : collection of Source
            Who is known.
        """
        for key in keys:
            before = self._partner.get(key)
            if before is None:
                continue
            if before not in present:
                self._taken[key] = self.name_of(before)
                del self._partner[key]
            elif key in alone:
                if before in self._taken and self._taken[before] == self._known_name(key):
                    del self._taken[before]
                del self._partner[key]

    def join(
        self, key: ListKey, source: Source, since: Callable[[int], float], in_use: Collection[int]
    ) -> int:
        """Let a row of another ship and one known before be one target, and return its name.

        Parameters
        ----------
        key : ListKey
            The row of the other ship.
        source : Source
            Who is known.
        since : callable
            Returns since when a name has been that of a confirmed row, ns; infinite = it is not.
        in_use : collection of int
            Names of other targets.
        """
        self._partner[key] = source
        name, other = self.name_of(source), self._known_name(key)
        if other is not None and other not in in_use and since(other) < since(name):
            self._taken[source] = name = other
        return name

    def alone(self, key: ListKey, in_use: Collection[int]) -> int:
        """Return the name of a row of another ship that is of no target known before.

        Parameters
        ----------
        key : ListKey
            The row of the other ship.
        in_use : collection of int
            Names of other targets.
        """
        for names in (self._taken, self._own_name):
            if names.get(key) in in_use:
                del names[key]
        return self.name_of(key)

    def _known_name(self, key: ListKey) -> int | None:
        return self._taken.get(key, self._own_name.get(key))
