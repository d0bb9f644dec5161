"""Whether the data of a run stand still, and who is waited for. No ROS."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger

STALL_SECONDS = 5.0
LOST_SECONDS = 60.0
"""What no node has moved a message for so long is taken for lost: the run goes on, and fails."""


class StallWatch:
    """Names who is waited for, and writes off what was lost on the way.

    Parameters
    ----------
    ledger : FlowLedger
        What every node still has to do.
    log_directory : Path
        Where the nodes' logs are.
    """

    def __init__(self, ledger: FlowLedger, log_directory: Path) -> None:
        self._ledger = ledger
        self._log_directory = log_directory
        self._moved = (-1, 0.0)
        self._told = 0.0

    def news(self, wall: float) -> Iterator[str]:
        """Return a sentence if nothing has moved for a while; wall is monotonic time, s."""
        if self._ledger.changes != self._moved[0]:
            self._moved = (self._ledger.changes, wall)
            self._told = wall
            return
        backlogs = self._ledger.backlogs()
        if backlogs and wall - self._told > STALL_SECONDS:
            self._told = wall
            worst = backlogs[0]
            yield (
                f"waiting for {worst.node}: it has not finished {worst.messages} messages of "
                f"{worst.topic}; its log is {self._log_directory / worst.node}.log"
            )
        if backlogs and wall - self._moved[1] > LOST_SECONDS:
            self._moved = (self._ledger.changes, wall)
            for lost in backlogs:
                self._ledger.write_off(lost)
