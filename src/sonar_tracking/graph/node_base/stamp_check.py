"""What is to be made of one message by its stamps."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sonar_tracking.records.time import NANOSECONDS, UNKNOWN_STAMP


class Verdict(Enum):
    """What to do with a message."""

    ACCEPT = "accept"
    GAP = "gap"
    """Use it, but data are missing before it."""
    DUPLICATE = "duplicate"
    """Ignore it: it was already received."""
    REJECT = "reject"
    HOLD = "hold"
    """Set it aside: those that follow tell whether it is to be used."""
    RESET = "reset"
    """Use it after everything was reset: the data begin again."""


@dataclass(frozen=True)
class StampCheck:
    """Verdict on one message.

    Attributes
    ----------
    verdict : Verdict
        What to do with it.
    sentence : str
        For the user; empty when nothing is wrong.
    next_stamp : int
        When the next message is due, ns, as far as that is believed.
    confirms : bool
        Whether the messages set aside are to be used, before this one.
    dropped : int
        Messages set aside before that will not be used.
    """

    verdict: Verdict
    sentence: str = ""
    next_stamp: int = UNKNOWN_STAMP
    confirms: bool = False
    dropped: int = 0


def seconds_text(stamp: int) -> str:
    """Return a stamp as people read it: seconds with three decimals."""
    return f"{stamp // NANOSECONDS}.{stamp % NANOSECONDS // 1_000_000:03d} s"
