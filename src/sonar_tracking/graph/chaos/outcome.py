"""What came of one fault. No ROS."""

from __future__ import annotations

import signal
from dataclasses import asdict, dataclass
from typing import Any

from sonar_tracking.graph.chaos.fault_plan import Fault, FaultKind
from sonar_tracking.graph.chaos.track_identities import Identities

INTERRUPTED = 128 + signal.SIGINT


@dataclass
class Outcome:
    """What came of one fault.

    Attributes
    ----------
    fault : Fault
        What happened.
    late : float or None
        By how much the latest of the lists that confirm tracks came later than due, s of the wall
        clock: the first is due an interval after the last before the fault, but not before the
        fault itself, each other an interval after the one before. None = none came.
    tracks : Identities or None
        Tracks established before, and kept; None = the run ended before that could be told.
    stalled, orphans, traceback : bool
        Whether the run stood still, left processes behind, or printed a traceback.
    exit_code : int or None
        Of the run, if the fault ended it.
    lost_messages : int or None
        Messages of nodes that were not killed the recording lacks; of the first fault of a run.
    hole : float or None
        Of a killed recorder: longest hole in the recording, s of the wall clock; the same.
    """

    fault: Fault
    late: float | None = None
    tracks: Identities | None = None
    stalled: bool = False
    orphans: bool = False
    traceback: bool = False
    exit_code: int | None = None
    lost_messages: int | None = None
    hole: float | None = None

    @property
    def failed(self) -> bool:
        """Whether the run did what no run may do, whatever is done to it."""
        wrong_end = self.fault.kind in (FaultKind.INTERRUPT, FaultKind.START) and (
            self.exit_code != INTERRUPTED
        )
        return self.stalled or self.orphans or self.traceback or wrong_end


def as_plain(outcome: Outcome) -> dict[str, Any]:
    """Return an outcome as JSON takes it."""
    values = asdict(outcome)
    values["fault"]["kind"] = outcome.fault.kind.value
    return {**values, "failed": outcome.failed}
