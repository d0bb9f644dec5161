"""What track fusion takes at one instant, and what it gives."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.errors import InputError, Notice
from sonar_tracking.motion import KinematicState, wrapped
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.positions import PositionTracks

ListKey = tuple[str, int]
"""Track list and the identifier of a row in it."""


@dataclass(frozen=True)
class FusionFrame:
    """Everything that others found at one instant.

    Attributes
    ----------
    stamp : int
        ns; later than that of the frame before.
    active : mapping of str to PositionTracks
        By their topic: tracks of what returns echoes, with what each update measured.
    bearings : tuple of BearingTracks
        Of each station that reports now.
    passive : mapping of str to PositionTracks
        By their topic: positions from bearings and lines.
    own_ship : KinematicState or None
        At the stamp; None = not known.
    foreign : mapping of str to PositionTracks
        By their topic: fused tracks of other ships.
    """

    stamp: int
    active: dict[str, PositionTracks] = field(default_factory=dict)
    bearings: tuple[BearingTracks, ...] = ()
    passive: dict[str, PositionTracks] = field(default_factory=dict)
    own_ship: KinematicState | None = None
    foreign: dict[str, PositionTracks] = field(default_factory=dict)

    def check_later_than(self, stamp: int) -> None:
        """Raise an :class:`InputError` if the frame is not later than that of a stamp, ns."""
        if self.stamp <= stamp:
            raise InputError(
                f"The frame at {self.stamp} ns is not later than the one before it, at {stamp} ns; "
                "send frames in order."
            )


@dataclass(frozen=True)
class FusionUpdate:
    """What follows from a frame.

    Attributes
    ----------
    tracks : PositionTracks
        The complete picture at the stamp of the frame.
    own_tracks : PositionTracks
        The same without what other ships tell.
    alignments : ArrayAlignments
        Of all arrays that have been heard of.
    notices : tuple of Notice
        What the user should know of the frame.
    """

    tracks: PositionTracks
    own_tracks: PositionTracks
    alignments: ArrayAlignments
    notices: tuple[Notice, ...]


@dataclass(frozen=True)
class HeardBearing:
    """One bearing of one bearing track, in ``map``.

    Attributes
    ----------
    key : BearingKey
        Whose.
    azimuths : tuple of float
        One, or left and right of a line array, rad.
    variance : float
        rad^2.
    station : ndarray, shape (2,)
        Where it was measured, m.
    array : int
        Which misalignment it has.
    lag : float
        By how much its stamp is late, s.
    """

    key: BearingKey
    azimuths: tuple[float, ...]
    variance: float
    station: FloatArray
    array: int
    lag: float = 0.0

    def with_variance(self, variance: float) -> HeardBearing:
        """Return the same bearing with another variance, rad^2."""
        return HeardBearing(self.key, self.azimuths, variance, self.station, self.array, self.lag)

    def with_azimuth(self, azimuth: float) -> HeardBearing:
        """Return the same bearing with one azimuth, rad, that is another one."""
        return HeardBearing(self.key, (azimuth,), self.variance, self.station, self.array, self.lag)

    def nearest(self, expected: float) -> float:
        """Return the azimuth nearest to one that is expected, rad; own ship's turns swap sides."""
        return min(self.azimuths, key=lambda one: abs(wrapped(one - expected)))

    def sides(self, expected: float) -> tuple[float, float]:
        """Return the nearer azimuth and that of the other side (NaN = there is none), rad."""
        near = self.nearest(expected)
        others = [one for one in self.azimuths if one != near]
        return near, others[0] if others else np.nan
