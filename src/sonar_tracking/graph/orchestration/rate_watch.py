"""Whether a run keeps the rate it was asked for, and who does not. No ROS.

Data that come from a recording or a simulator wait for the slowest node, which hides that it would
lose them if they came from a sensor. A run is therefore held to its rate: it says while it goes on
that it has fallen behind, and has failed if it ends behind. A hiccup that is made good is none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger

SLACK_SECONDS = 4.0
SLACK_SHARE = 0.05
"""A run may end so much later than its rate has it, s and share of its wall time."""

_FIRST_SAID = 2.0
_COUNTED = 0.5


class RateWatch:
    """Names the node that is behind when the data are.

    Parameters
    ----------
    ledger : FlowLedger
        What every node still has to do.
    sources : sequence of str
        Who delivers the data: they are slow if nobody else is.
    """

    def __init__(self, ledger: FlowLedger, sources: Sequence[str]) -> None:
        self._ledger = ledger
        self._source = ", ".join(sources) or "the recording"
        self._slow: Counter[str] = Counter()
        self._say_at = _FIRST_SAID

    def news(self, behind: float) -> Iterator[str]:
        """Return a sentence if the data are later than ever, by so many s of the wall clock."""
        if behind > _COUNTED:
            backlogs = self._ledger.backlogs()
            self._slow[backlogs[0].node if backlogs else self._source] += 1
        if behind > self._say_at:
            self._say_at = 2.0 * behind
            yield f"{self._named(behind)}."

    def failure(self, behind: float, wall_seconds: float) -> str:
        """Return what is to be said of a run that has ended; empty = it has kept its rate.

        Parameters
        ----------
        behind : float
            By which it has ended later than its rate has it, s of the wall clock.
        wall_seconds : float
            How long data have been flowing, s.
        """
        if behind <= max(SLACK_SECONDS, SLACK_SHARE * wall_seconds):
            return ""
        return (
            f"{self._named(behind)}: give it less to do, lower --rate, or let the data wait with "
            "--rate max."
        )

    def _named(self, behind: float) -> str:
        """Return by how much the run is behind, and who has been waited for most of the time."""
        slow = self._slow.most_common(1)
        who = slow[0][0] if slow else self._source
        return f"the run is {behind:.1f} s behind the rate asked for, because of {who}"
