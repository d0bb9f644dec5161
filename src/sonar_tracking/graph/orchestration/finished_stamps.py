"""How far each consumer has got in the data, so that a restarted source goes on behind it. No ROS.

A source that repeats what was received already gives nothing but duplicates, and to a consumer of
slow data a step back that looks like a new run; one that leaves out what a consumer has not
received makes a gap.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping


class FinishedStamps:
    """Keeps the stamp of the last message each consumer has finished of each topic."""

    def __init__(self) -> None:
        self._last: dict[tuple[str, str], int] = {}

    def finished(self, node: str, topic: str, stamp: int) -> None:
        """Note that a consumer has finished a message with a stamp, ns."""
        self._last[node, topic] = stamp

    def everywhere(
        self, topics: Collection[str], consumers: Mapping[str, Collection[str]]
    ) -> int | None:
        """Return the stamp up to which all consumers have finished all of some topics, ns.

        Parameters
        ----------
        topics : collection of str
            Resolved names.
        consumers : mapping of str to collection of str
            Of each topic, those that live.

        Returns
        -------
        int or None
            None = one has finished nothing yet, or there is none.
        """
        stamps = [self._last.get((node, topic)) for topic in topics for node in consumers[topic]]
        known = [stamp for stamp in stamps if stamp is not None]
        return min(known) if known and len(known) == len(stamps) else None
