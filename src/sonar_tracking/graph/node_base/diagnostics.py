"""What a node says about itself on ``/diagnostics``: one status per concern.

A new problem is logged and published at once; the same problem (same concern and culprit) again
only after :data:`REPEAT_AFTER` of data time, so that a permanent fault does not flood the log.
Times are data times; the wall clock only keeps what is said again and again to what people can see
where data flow many times faster than real time.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.impl.rcutils_logger import RcutilsLogger

from sonar_tracking.errors import LONGEST_SENTENCE, Severity, shown
from sonar_tracking.graph.catalogue.run_identity import signed
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.records.time import NANOSECONDS

REPEAT_AFTER = 10 * NANOSECONDS
"""A problem is active, and not said again, for this long in data time, ns."""

MATCHED = "matched"
"""Concern: number of matched remote endpoints by topic."""

NEIGHBOURS = "neighbours"
"""Concern: number of endpoints ever found by topic and node, see
:class:`sonar_tracking.graph.node_base.neighbours.Neighbours`."""

UNEXPECTED = "unexpected errors"
"""Concern: errors of the program itself, not of its input. A run in which they occur has failed."""

PERMANENT = None
"""Data time of a problem that stays until the node ends."""

Values = Callable[[], Mapping[str, object]]

_LEVELS = {
    Severity.OK: DiagnosticStatus.OK,
    Severity.WARN: DiagnosticStatus.WARN,
    Severity.ERROR: DiagnosticStatus.ERROR,
}


def kind_of(sentence: str) -> str:
    """Return a sentence without its numbers: equal for two problems of the same kind."""
    return re.sub(r"\d+(\.\d+)?", "#", sentence)


@dataclass
class _Problem:
    severity: Severity
    sentence: str
    seen: int | None
    said: int | None


class Diagnostics:
    """Collects the state of all concerns of one node.

    Parameters
    ----------
    node_name : str
        Statuses are named ``"<node>: <concern>"``.
    logger : logger
        Where new problems are logged.
    publish : callable
        Publishes one DiagnosticArray.
    least_pause : float
        Between two publications without news, s of the wall clock.
    """

    def __init__(
        self,
        node_name: str,
        logger: RcutilsLogger,
        publish: Callable[[DiagnosticArray], None],
        least_pause: float = 0.0,
    ) -> None:
        self._node_name = node_name
        self._logger = logger
        self._publish = publish
        self._values: dict[str, Values] = {}
        self._problems: dict[str, dict[str, _Problem]] = {}
        self._least_pause = least_pause
        self._now = 0
        self._published = 0.0

    def add(self, concern: str, values: Values) -> None:
        """Add a concern whose numbers are asked for at each publication."""
        self._values[concern] = values
        self._problems.setdefault(concern, {})

    def advance(self, stamp: int) -> None:
        """Tell the data time, ns."""
        self._now = stamp

    def report(
        self, concern: str, culprit: str, severity: Severity, sentence: str, lasting: bool = False
    ) -> None:
        """Report one problem; severity OK withdraws it.

        Parameters
        ----------
        concern, culprit : str
            A concern has one problem per culprit; the newest counts.
        severity : Severity
            How bad it is.
        sentence : str
            What is wrong and what to do.
        lasting : bool
            True = it stays until withdrawn; otherwise it fades after REPEAT_AFTER.
        """
        sentence = shown(sentence, LONGEST_SENTENCE)
        problems = self._problems.setdefault(concern, {})
        known = problems.get(culprit)
        if severity is Severity.OK:
            if problems.pop(culprit, None) is not None:
                self.publish()
            return
        seen = PERMANENT if lasting else self._now
        if known is not None and self._is_known(known, severity, sentence):
            known.sentence, known.seen = sentence, seen
            return
        said = PERMANENT if lasting else self._now
        problems[culprit] = _Problem(severity, sentence, seen, said)
        if severity is Severity.ERROR:
            self._logger.error(sentence)
        else:
            self._logger.warning(sentence)
        self.publish()

    def publish_if_due(self) -> None:
        """Publish the state of all concerns, unless that was done a moment ago."""
        if time.monotonic() - self._published >= self._least_pause:
            self.publish()

    def publish(self) -> None:
        """Publish the state of all concerns."""
        self._published = time.monotonic()
        message = DiagnosticArray()
        message.header.stamp = time_from_stamp(self._now)
        for concern, problems in list(self._problems.items()):
            for culprit in [c for c, p in problems.items() if not self._is_fresh(p.seen)]:
                del problems[culprit]
            message.status.append(self._status(concern, problems))
        self._publish(message)

    def forget(self) -> None:
        """Forget what fades: the data begin again."""
        for problems in self._problems.values():
            for culprit in [c for c, p in problems.items() if p.seen is not PERMANENT]:
                del problems[culprit]

    def _is_known(self, known: _Problem, severity: Severity, sentence: str) -> bool:
        same = known.severity is severity and kind_of(known.sentence) == kind_of(sentence)
        return same and self._is_fresh(known.said)

    def _is_fresh(self, since: int | None) -> bool:
        return since is PERMANENT or 0 <= self._now - since < REPEAT_AFTER

    def _status(self, concern: str, problems: Mapping[str, _Problem]) -> DiagnosticStatus:
        active = list(problems.values())
        worst = max((problem.severity for problem in active), default=Severity.OK)
        values = self._values.get(concern, dict)()
        return DiagnosticStatus(
            level=_LEVELS[worst],
            name=f"{self._node_name}: {concern}",
            message=" ".join(problem.sentence for problem in reversed(active)) or "ok",
            hardware_id=signed(self._node_name),
            values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
        )
