"""Messages that are set aside because of their stamps, and how many must agree to be believed."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Doubt(Enum):
    """Why a message does not go on with the data so far."""

    GAP = "gap"
    OVERLAP = "overlap"
    EARLIER = "earlier"
    OTHER_SENSOR = "other sensor"
    BEGINNING = "beginning"
    AFTER_END = "after the end"


NEEDED = {Doubt.GAP: 2, Doubt.OVERLAP: 2, Doubt.AFTER_END: 2}
NEEDED_OTHERWISE = 3
"""Messages that agree and are believed, the first included."""

OUTLASTS = {Doubt.EARLIER, Doubt.OTHER_SENSOR}
"""What is believed only if established data are silent for longer than they ever were."""


@dataclass(frozen=True)
class Candidate:
    """A message that does not go on with the data so far, set aside.

    Attributes
    ----------
    stamp, next_stamp : int
        Of the message, ns.
    sensor_id : str
        Of the message.
    doubt : Doubt
        Why it does not go on.
    sentence : str
        The same for the user, without its end.
    """

    stamp: int
    next_stamp: int
    sensor_id: str
    doubt: Doubt
    sentence: str
