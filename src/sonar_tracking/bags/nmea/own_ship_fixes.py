"""Where own ship was, when, and how it headed: the sentences of one instant put together.

A position opens an instant, and the next later one closes it. Sentences without a time (HDT, VTG,
VHW) are taken to be of the instant before them, those ahead of the first position of just before
it; where none comes, the last one holds for a while.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from sonar_tracking.bags.nmea.own_ship_sentences import OwnShipReport
from sonar_tracking.bags.nmea.sentence_time import SentenceTime
from sonar_tracking.errors import InputError

KEPT_SECONDS = 5.0
"""For so long heading and speed hold after they were told, s."""

SLOW = 0.2
"""Below this the course made good says nothing of the heading, m/s."""

RESTART_SECONDS = 10.0
"""A step back by more is a source that begins again, s."""

LATE = "its time is before that of a position before it; it is not used"


@dataclass(frozen=True, slots=True)
class OwnShipFix:
    """Own ship at one instant.

    Attributes
    ----------
    instant : float
        On the time line of the sentences, s.
    latitude_deg, longitude_deg : float
        deg, north and east positive.
    heading_deg : float
        Of the bow, from true north, deg; NaN = unknown.
    course_deg : float
        Made good, from true north, deg; NaN = unknown.
    speed : float
        Over ground, m/s; NaN = unknown.
    """

    instant: float
    latitude_deg: float
    longitude_deg: float
    heading_deg: float = math.nan
    course_deg: float = math.nan
    speed: float = math.nan


@dataclass
class _Kept:
    """Values that were told without a time, and the instant they are taken to be of.

    The first of an instant are those of it, the last of it hold until others come.
    """

    first: tuple[float, ...] = ()
    last: tuple[float, ...] = ()
    instant: float = math.nan

    def take(self, instant: float, *values: float) -> None:
        """Keep values, unless the first of them is not known."""
        if math.isnan(values[0]):
            return
        if self.instant != instant:
            self.first, self.instant = values, instant
        self.last = values

    def begin(self, instant: float) -> None:
        """Take what came ahead of the first instant to be of just before it."""
        if self.instant == -math.inf:
            self.instant = math.nextafter(instant, -math.inf)

    def at(self, instant: float) -> tuple[float, ...]:
        """Return what holds at an instant; empty = nothing does."""
        if abs(instant - self.instant) > KEPT_SECONDS or not self.last:
            return ()
        return self.first if instant == self.instant else self.last


class OwnShipFixes:
    """Puts the reports of a stream together.

    Parameters
    ----------
    time : SentenceTime
        The time line of the stream.

    Attributes
    ----------
    course_for_heading : int
        Instants at which nothing told the heading.
    """

    def __init__(self, time: SentenceTime) -> None:
        self.time = time
        self.course_for_heading = 0
        self._open: OwnShipFix | None = None
        self._heading = _Kept()
        self._water_heading = _Kept()
        self._motion = _Kept()
        self._closed = -math.inf

    def take(self, report: OwnShipReport) -> OwnShipFix | None:
        """Take one report; return the instant that it closes, if it does.

        Raises
        ------
        InputError
            If its time is before what has been told already.
        """
        closed = None
        if not math.isnan(report.time_of_day):
            closed = self._take_time(report)
        instant = self._closed if self._open is None else self._open.instant
        heading = self._water_heading if report.format == "VHW" else self._heading
        heading.take(instant, report.heading_deg)
        self._motion.take(instant, report.speed, report.course_deg)
        return closed

    def close(self) -> OwnShipFix | None:
        """Return the instant that is open, if one is: nothing more of it is to come."""
        fix, self._open = self._open, None
        if fix is None:
            return None
        self._closed = fix.instant
        heading = self._heading.at(fix.instant) or self._water_heading.at(fix.instant)
        self.course_for_heading += not heading
        speed, course = self._motion.at(fix.instant) or (math.nan, math.nan)
        return replace(fix, heading_deg=(heading or (math.nan,))[0], course_deg=course, speed=speed)

    def _take_time(self, report: OwnShipReport) -> OwnShipFix | None:
        instant = self.time.take(report.time_of_day, report.day)
        last = self._closed if self._open is None else self._open.instant
        closed = None
        if instant < last - RESTART_SECONDS:
            closed = self.close()
            self._heading, self._water_heading, self._motion = _Kept(), _Kept(), _Kept()
            self._closed = last = -math.inf
        if instant < last and report.has_position:
            raise InputError(f"{report.format}: {LATE}")
        if instant > last:
            closed = closed or self.close()
            if report.has_position:
                place = (report.latitude_deg, report.longitude_deg)
                self._open = OwnShipFix(instant, *place)
                for kept in (self._heading, self._water_heading, self._motion):
                    kept.begin(instant)
        return closed
