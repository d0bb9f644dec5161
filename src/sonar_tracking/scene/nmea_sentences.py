"""Tracks as sentences of NMEA 0183, which chart plotters show as radar targets.

References
----------
International Electrotechnical Commission (2016). IEC 61162-1, edition 5: sentences TLL and TTM.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import datetime, timezone

import numpy as np

from sonar_tracking.geodesy import surface_places
from sonar_tracking.motion import compass_from_vector
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import MAP_FRAME, PositionTracks
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.scene.nmea_format import KNOT, NAUTICAL_MILE, with_checksum

INTERVAL = 2 * NANOSECONDS
"""Shortest time between two sentences of one kind about one track, ns."""

MOST_TARGETS = 99
"""Numbers of targets have two digits; 00 is that of no target."""


def tll_sentence(
    number: int, latitude_deg: float, longitude_deg: float, name: str, stamp: int, is_lost: bool
) -> str:
    """Return the sentence TLL: latitude and longitude of a target.

    Parameters
    ----------
    number : int
        Of the target, 1 to 99.
    latitude_deg, longitude_deg : float
        deg, north and east positive.
    name : str
        Of the target.
    stamp : int
        ns.
    is_lost : bool
        Whether it is not seen now.
    """
    latitude = _angle(latitude_deg, 2, "NS")
    longitude = _angle(longitude_deg, 3, "EW")
    status = "Q" if is_lost else "T"
    return with_checksum(
        f"RATLL,{number:02d},{latitude},{longitude},{name},{_time(stamp)},{status},"
    )


def ttm_sentence(
    number: int,
    relative: tuple[float, float, float, float],
    velocity: tuple[float, float],
    name: str,
    stamp: int,
    is_lost: bool,
) -> str:
    """Return the sentence TTM: a target as own ship sees it, in nautical miles and knots.

    Parameters
    ----------
    number, name, stamp, is_lost
        As of :func:`tll_sentence`.
    relative : tuple of float
        East and north of own ship, m, and the rates of both, m/s.
    velocity : tuple of float
        Of the target over ground, east and north, m/s.
    """
    east, north, east_rate, north_rate = relative
    distance = math.hypot(east, north) / NAUTICAL_MILE
    bearing = float(compass_from_vector((east, north)))
    speed, course = math.hypot(*velocity) / KNOT, float(compass_from_vector(velocity))
    closest = ","
    squared = east_rate**2 + north_rate**2
    if squared > 0.0:
        delay = -(east * east_rate + north * north_rate) / squared
        miss = math.hypot(east + east_rate * delay, north + north_rate * delay) / NAUTICAL_MILE
        closest = f"{miss:.2f},{delay / 60.0:.2f}"
    status = "Q" if is_lost else "T"
    return with_checksum(
        f"RATTM,{number:02d},{distance:.2f},{_degrees(bearing)},T,{speed:.1f},{_degrees(course)},T,"
        f"{closest},N,{name},{status},,{_time(stamp)},A"
    )


@dataclass
class TrackSentences:
    """Sentences of successive pictures, at most one of a kind and track in two seconds.

    A track keeps its number as long as it is in the picture; a number that is free is given again.

    Attributes
    ----------
    datum : Datum or None
        Of ``map``; None = no TLL.
    unnumbered : int
        Rows that found all 99 numbers taken.
    """

    datum: Datum | None = None
    unnumbered: int = 0
    _numbers: dict[int, int] = field(default_factory=dict)
    _told: dict[int, int] = field(default_factory=dict)

    def of_picture(self, tracks: PositionTracks, own_ship: OwnShipState | None) -> list[str]:
        """Return the sentences of the established tracks of a picture.

        Parameters
        ----------
        tracks : PositionTracks
            In ``map``; others give none.
        own_ship : OwnShipState or None
            The latest; None = no TTM.
        """
        shown = tracks.selected(tracks.established & np.isfinite(tracks.state[:, :2]).all(axis=1))
        self._forget(set(shown.id.tolist()))
        sentences: list[str] = []
        if shown.frame_id != MAP_FRAME or not len(shown):
            return sentences
        places = None if self.datum is None else surface_places(shown.state[:, :2], self.datum)
        for row, track in enumerate(shown.id.tolist()):
            if 0 <= shown.stamp - self._told.get(track, -INTERVAL) < INTERVAL:
                continue
            number = self._number(track)
            if number is None:
                self.unnumbered += 1
                continue
            self._told[track] = shown.stamp
            head = (f"T{track}", shown.stamp, bool(shown.status[row] == TrackStatus.COASTED))
            x, y, vx, vy = shown.state[row].tolist()
            if own_ship is not None and math.isfinite(vx) and math.isfinite(vy):
                relative = _relative((x, y, vx, vy), own_ship)
                sentences.append(ttm_sentence(number, relative, (vx, vy), *head))
            if places is not None:
                latitude, longitude = places[row].tolist()
                sentences.append(tll_sentence(number, latitude, longitude, *head))
        return sentences

    def _forget(self, present: set[int]) -> None:
        self._numbers = {track: n for track, n in self._numbers.items() if track in present}
        self._told = {track: stamp for track, stamp in self._told.items() if track in present}

    def _number(self, track: int) -> int | None:
        if track not in self._numbers:
            free = _first_free(self._numbers.values())
            if free is None:
                return None
            self._numbers[track] = free
        return self._numbers[track]


def _first_free(taken: Iterable[int]) -> int | None:
    used = set(taken)
    return next((number for number in range(1, MOST_TARGETS + 1) if number not in used), None)


def _relative(
    state: tuple[float, float, float, float], own_ship: OwnShipState
) -> tuple[float, float, float, float]:
    forward, port = own_ship.velocity
    cosine, sine = math.cos(own_ship.yaw), math.sin(own_ship.yaw)
    x, y, vx, vy = state
    return (
        x - own_ship.position[0],
        y - own_ship.position[1],
        vx - (cosine * forward - sine * port),
        vy - (sine * forward + cosine * port),
    )


def _angle(angle_deg: float, digits: int, signs: str) -> str:
    """Return degrees and minutes to 1e-4 of a minute (0.2 m), and the side."""
    ten_thousandths = round(abs(angle_deg) * 600_000)
    degrees, rest = divmod(ten_thousandths, 600_000)
    return f"{degrees:0{digits}d}{rest / 10_000:07.4f},{signs[angle_deg < 0]}"


def _degrees(angle_deg: float) -> str:
    """Return an angle to a tenth of a degree, below 360."""
    return f"{round(angle_deg * 10) % 3600 / 10:.1f}"


def _time(stamp: int) -> str:
    """Return the time of day, to 0.01 s, cut off rather than rounded into another day."""
    whole, rest = divmod(stamp, NANOSECONDS)
    instant = datetime.fromtimestamp(whole, tz=timezone.utc)
    return f"{instant:%H%M%S}.{rest // 10_000_000:02d}"
