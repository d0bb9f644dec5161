"""What an operator tells the trackers, whoever shows the tracks."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from sonar_tracking.records.positions import TrackHypothesis

LINE_BANDWIDTH = 1.0
"""Of own ship's lines that an operator marks without saying how wide they are, Hz."""


class CommandKind(IntEnum):
    """What is to be done, as in the messages."""

    START_TRACK = 1
    END_TRACK = 2
    MERGE_TRACKS = 3
    CHOOSE_SIDE = 4
    RENAME_TRACK = 5
    MARK_OWN_SHIP_LINE = 6
    UNMARK_OWN_SHIP_LINE = 7


@dataclass(frozen=True)
class OwnShipLine:
    """Frequencies that are taken for a line of own ship.

    Attributes
    ----------
    frequency, bandwidth : float
        Middle and width, as received, Hz.
    sensor_id : str
        Whose lines are meant; empty = those of all sensors.
    """

    frequency: float
    bandwidth: float = LINE_BANDWIDTH
    sensor_id: str = ""

    def holds(self, frequency: float, sensor_id: str) -> bool:
        """Return whether a line (Hz) that a sensor hears is this one."""
        near = 2.0 * abs(frequency - self.frequency) <= self.bandwidth
        return near and self.sensor_id in ("", sensor_id)


@dataclass(frozen=True)
class OperatorCommand:
    """One command.

    Attributes
    ----------
    kind : CommandKind
        What is to be done.
    topic : str
        Track list that is meant, as in a graph without a namespace.
    stamp : int
        When it takes effect: before the first datum at or after it, ns; 0 = before the next one.
    id, other_id : int
        Tracks of that list; 0 = none.
    arrival_angle : float
        From array broadside, rad.
    position : tuple of float
        x and y in ``map``, m.
    side : TrackHypothesis
        Of the line array; SINGLE = none.
    line : OwnShipLine
        Of own ship.
    name : str
        Of the target.
    """

    kind: CommandKind
    topic: str
    stamp: int = 0
    id: int = 0
    other_id: int = 0
    arrival_angle: float = np.nan
    position: tuple[float, float] = (np.nan, np.nan)
    side: TrackHypothesis = TrackHypothesis.SINGLE
    line: OwnShipLine = OwnShipLine(np.nan)
    name: str = ""
