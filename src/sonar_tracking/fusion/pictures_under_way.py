"""Own pictures that are being made, together with those of other fusions."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.errors import Notice
from sonar_tracking.fusion.filters_together import LinkedBearings
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.station_bearings import StationBearings
from sonar_tracking.records.bearings import BearingTracks


@dataclass(frozen=True)
class PictureUnderWay:
    """A picture that has taken in the echoes of its instant.

    Attributes
    ----------
    stations : list of BearingTracks
        Those that report then.
    notices : list of Notice
        What the user should know so far.
    """

    stations: list[BearingTracks]
    notices: list[Notice]


@dataclass(frozen=True)
class HeardOfStation:
    """What a station heard.

    Attributes
    ----------
    told : StationBearings
        All of it.
    found : list of HeardBearing
        Bearings that are of one target each.
    linked : LinkedBearings
        Those of them whose targets are known.
    """

    told: StationBearings
    found: list[HeardBearing]
    linked: LinkedBearings
