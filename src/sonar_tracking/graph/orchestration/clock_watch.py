"""Whether somebody else moves the clock of a run that goes on. No ROS."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator

PERIOD = 1.0
"""Between looks, s of the wall clock."""

_NAMELESS = "UNKNOWN"


class ClockWatch:
    """Tells once of each who publishes the clock, too."""

    def __init__(self) -> None:
        self._looked = 0.0
        self._told: set[str] = set()

    def news(self, wall: float, others: Callable[[], Collection[str]]) -> Iterator[str]:
        """Return a sentence for each who is new.

        Parameters
        ----------
        wall : float
            Monotonic wall time, s.
        others : callable
            Returns the full names of the other publishers; asked now and then only.
        """
        if wall - self._looked < PERIOD:
            return
        self._looked = wall
        # The name of an endpoint arrives a little later than the endpoint itself.
        for name in sorted({name for name in others() if _NAMELESS not in name} - self._told):
            self._told.add(name)
            yield (
                f"{name} publishes the clock of this run, too: the data do not follow it, but "
                "other nodes may; end it, or choose another ROS_DOMAIN_ID or --namespace."
            )
