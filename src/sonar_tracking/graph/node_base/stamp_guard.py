"""Checks of the stamps of one input topic: what is used, ignored, rejected, or starts afresh.

Pure stamps, no ROS. Streams promise rising stamps and, with ``next_stamp``, when the next message
is due. The guard holds them to it, so that everything behind it may rely on order.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from enum import Enum

from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS, UNKNOWN_STAMP

TOLERANCE = 1_000
"""Rounding of stamps that is not a gap or an overlap, ns."""

_REMEMBERED = 256

REORDERED_MESSAGES = 5
"""Of data slower than reset_after so many may come late before that is a new beginning."""


class Verdict(Enum):
    """What to do with a message."""

    ACCEPT = "accept"
    GAP = "gap"
    """Use it, but data are missing before it."""
    DUPLICATE = "duplicate"
    """Ignore it: it was already received."""
    REJECT = "reject"
    RESET = "reset"
    """Use it after everything was reset: the data begin again."""


@dataclass(frozen=True)
class StampCheck:
    """Verdict on one message, and the sentence for the user (empty when nothing is wrong)."""

    verdict: Verdict
    sentence: str = ""


class StampGuard:
    """Holds one topic to rising stamps from one sensor.

    Parameters
    ----------
    topic : str
        Named in the sentences.
    reset_after : int
        A step back by more than this many ns, and by more than a few of the usual intervals
        between messages, is a new beginning; a smaller one is an error.
    """

    def __init__(self, topic: str, reset_after: int) -> None:
        self._topic = topic
        self._reset_after = reset_after
        self.reset()

    def reset(self) -> None:
        """Forget everything received so far."""
        self.last_stamp = UNKNOWN_STAMP
        self.expected = UNKNOWN_STAMP
        self._sensor_id: str | None = None
        self._recent: deque[int] = deque(maxlen=_REMEMBERED)
        self._begun_again: int | None = None
        self._ignored = 0

    def expect_new_beginning(self, stamp: int) -> None:
        """Tell that another input of the node has begun again at a stamp, ns.

        What still comes from before is ignored, as long as it can be told from the new data.
        """
        if self.last_stamp == UNKNOWN_STAMP or self.expected == END_OF_DATA:
            self.reset()
        else:
            self._begun_again = stamp
            self._ignored = 0

    def check(self, stamp: int, next_stamp: int, sensor_id: str) -> StampCheck:
        """Judge one message and, unless it is refused, remember it.

        Parameters
        ----------
        stamp, next_stamp : int
            Of the message, ns.
        sensor_id : str
            Of the message.

        Returns
        -------
        StampCheck
            On RESET the guard has already forgotten what was before.
        """
        if self._begun_again is not None:
            if self._is_from_before(stamp, self._begun_again):
                self._ignored += 1
                return StampCheck(
                    Verdict.DUPLICATE,
                    f"{self._topic}: the message stamped {seconds_text(stamp)} was ignored: it is "
                    "from before the data began again.",
                )
            self.reset()
        check = self._judge(stamp, next_stamp, sensor_id)
        if check.verdict is Verdict.RESET:
            self.reset()
        if check.verdict in (Verdict.ACCEPT, Verdict.GAP, Verdict.RESET):
            self.last_stamp = stamp
            self.expected = next_stamp
            self._sensor_id = sensor_id
            self._recent.append(stamp)
        return check

    def _is_from_before(self, stamp: int, begun_again: int) -> bool:
        """Tell whether a message goes on with the old data, and no queue is longer than it."""
        goes_on = stamp > self.last_stamp and stamp > begun_again + self._reset_after
        return goes_on and self._ignored < _REMEMBERED

    def _judge(self, stamp: int, next_stamp: int, sensor_id: str) -> StampCheck:
        at = f"{self._topic}: the message stamped {seconds_text(stamp)}"
        if stamp <= UNKNOWN_STAMP:
            return StampCheck(
                Verdict.REJECT,
                f"{self._topic}: a message without a stamp was rejected; "
                "the sender must set header.stamp to the instant of the data.",
            )
        if next_stamp != UNKNOWN_STAMP and next_stamp < stamp:
            return StampCheck(
                Verdict.REJECT,
                f"{at} was rejected: its next_stamp {seconds_text(next_stamp)} is earlier; "
                "the sender must set next_stamp to the stamp of the message after it, or zero.",
            )
        if self.last_stamp == UNKNOWN_STAMP:
            return StampCheck(Verdict.ACCEPT)
        if stamp == self.last_stamp:
            return self._duplicate(at)
        if self.expected == END_OF_DATA:
            return StampCheck(
                Verdict.RESET,
                f"{self._topic}: data begin again at {seconds_text(stamp)} after the end of the "
                "data; everything was reset.",
            )
        back = self.last_stamp - stamp
        if back > self._largest_step_back():
            return StampCheck(
                Verdict.RESET,
                f"{self._topic}: stamps went back by {back / NANOSECONDS:.3f} s to "
                f"{seconds_text(stamp)} (a looped recording or a restarted source?); "
                "everything was reset.",
            )
        if sensor_id != self._sensor_id:
            return StampCheck(
                Verdict.REJECT,
                f"{at} was rejected: it comes from sensor {sensor_id!r}, but the data so far come "
                f"from {self._sensor_id!r}; give each sensor its own namespace.",
            )
        return self._judge_order(stamp, at)

    def _largest_step_back(self) -> int:
        """Return by how much a late message may be late, ns."""
        intervals = len(self._recent) - 1
        usual = (self._recent[-1] - self._recent[0]) // intervals if intervals > 0 else 0
        return max(self._reset_after, REORDERED_MESSAGES * usual)

    def _judge_order(self, stamp: int, at: str) -> StampCheck:
        if stamp < self.last_stamp:
            if stamp in self._recent:
                return self._duplicate(at)
            back = (self.last_stamp - stamp) / NANOSECONDS
            return StampCheck(
                Verdict.REJECT,
                f"{at} was rejected: it is {back:.3f} s earlier than the one before; the sender "
                "must publish in order (a step back by more than "
                f"{self._largest_step_back() / NANOSECONDS:g} s, parameter reset_after or a few "
                "messages, is taken as a new beginning).",
            )
        if self.expected == UNKNOWN_STAMP:
            return StampCheck(Verdict.ACCEPT)
        if stamp < self.expected - TOLERANCE:
            return StampCheck(
                Verdict.REJECT,
                f"{at} was rejected: the message before it announced "
                f"{seconds_text(self.expected)} as the next stamp; the sender must not publish "
                "overlapping data (is there a second publisher?).",
            )
        if stamp > self.expected + TOLERANCE:
            gap = (stamp - self.expected) / NANOSECONDS
            return StampCheck(
                Verdict.GAP,
                f"{self._topic}: {gap:.3f} s of data are missing between "
                f"{seconds_text(self.expected)} and {seconds_text(stamp)}; "
                "check the source and whether messages are lost on the way.",
            )
        return StampCheck(Verdict.ACCEPT)

    def _duplicate(self, at: str) -> StampCheck:
        return StampCheck(
            Verdict.DUPLICATE,
            f"{at} was ignored: it was already received (is something publishing twice?).",
        )


def seconds_text(stamp: int) -> str:
    """Return a stamp as people read it: seconds with three decimals."""
    return f"{stamp // NANOSECONDS}.{stamp % NANOSECONDS // 1_000_000:03d} s"
