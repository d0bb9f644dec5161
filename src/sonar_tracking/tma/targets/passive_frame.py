"""What target motion analysis takes at one instant, and what it gives."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.errors import Notice
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import UNKNOWN_STAMP


@dataclass(frozen=True)
class UnusableBearings:
    """Bearing tracks that could not be read; the tracks go on without.

    Attributes
    ----------
    sensor_id : str
        Who sent them.
    next_stamp : int
        Their watermark, ns.
    """

    sensor_id: str
    next_stamp: int = UNKNOWN_STAMP


@dataclass(frozen=True)
class PassiveFrame:
    """Everything measured at one instant.

    Attributes
    ----------
    stamp : int
        ns; later than that of the frame before.
    bearings : tuple of BearingTracks
        Of each station that reports now.
    lines : tuple of FrequencyLines
        Of each station that reports now.
    own_ship : KinematicState or None
        At the stamp; None = not known.
    unusable : tuple of UnusableBearings
        Of stations that report now, but nothing that can be used.
    """

    stamp: int
    bearings: tuple[BearingTracks, ...] = ()
    lines: tuple[FrequencyLines, ...] = ()
    own_ship: KinematicState | None = None
    unusable: tuple[UnusableBearings, ...] = ()


@dataclass(frozen=True)
class TmaUpdate:
    """What follows from a frame.

    Attributes
    ----------
    tracks : PositionTracks or None
        The complete picture at the stamp of the frame; None = the frame had no bearing tracks.
    notices : tuple of Notice
        What the user should know of the frame.
    alignments : ArrayAlignments or None
        How the stations heard so far are turned from what their data tell; None = it is not
        estimated.
    """

    tracks: PositionTracks | None
    notices: tuple[Notice, ...]
    alignments: ArrayAlignments | None
