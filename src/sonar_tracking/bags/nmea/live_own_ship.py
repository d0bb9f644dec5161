"""Own ship's state from sentences as they come."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from sonar_tracking.bags.nmea.own_ship_fixes import KEPT_SECONDS, SLOW, OwnShipFix, OwnShipFixes
from sonar_tracking.bags.nmea.own_ship_sentences import own_ship_report
from sonar_tracking.bags.nmea.sentence_time import SentenceTime
from sonar_tracking.bags.nmea.sentences import read_sentence
from sonar_tracking.bags.nmea.ship_histories import vectors
from sonar_tracking.errors import InputError
from sonar_tracking.geodesy import FARTHEST, north_azimuths, surface_distances, surface_positions
from sonar_tracking.motion import wrapped
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.datum import Datum, datum_at
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import seconds

NO_DATE = "a position came before any date was known (RMC or ZDA); it is not used"
FAR = "a position lies farther than 200 km from the datum; it is not used"
NO_HEADING = "a position came without a heading (HDT or VHW); the course made good is taken"


class LiveOwnShip:
    """Makes states of the lines of a stream, each once all of its instant has come.

    Parameters
    ----------
    datum : Datum or None
        Of ``map``; None = at the first position.

    Attributes
    ----------
    datum : Datum or None
        The same, known from the first position on.
    used : Counter of str
        Sentences of each format that tell something of own ship.
    faults : Counter of str
        How many lines or positions of each kind could not be used, or not fully.
    """

    def __init__(self, datum: Datum | None = None) -> None:
        self.datum = datum
        self.used: Counter[str] = Counter()
        self.faults: Counter[str] = Counter()
        self._fixes = OwnShipFixes(SentenceTime())
        self._last: OwnShipState | None = None

    def take(self, line: bytes) -> OwnShipState | None:
        """Take one line; return the state of the instant that it closes, if it does."""
        try:
            report = own_ship_report(read_sentence(line))
            if report is None:
                return None
            self.used[report.format] += 1
            return self._state(self._fixes.take(report))
        except InputError as error:
            self.faults[str(error)] += 1
            return None

    def close(self) -> OwnShipState | None:
        """Return the state of the instant that is open: nothing has come for a while."""
        try:
            return self._state(self._fixes.close())
        except InputError as error:
            self.faults[str(error)] += 1
            return None

    def _state(self, fix: OwnShipFix | None) -> OwnShipState | None:
        if fix is None:
            return None
        if not self._fixes.time.is_dated:
            raise InputError(NO_DATE)
        datum = self.datum or datum_at(fix.latitude_deg, fix.longitude_deg)
        place = (np.array(fix.latitude_deg), np.array(fix.longitude_deg))
        if surface_distances(*place, datum) > FARTHEST:
            raise InputError(FAR)
        self.datum = datum
        position, north = surface_positions(*place, datum), float(north_azimuths(*place, datum))
        stamp, last = self._fixes.time.stamp(fix.instant), self._last
        elapsed = math.inf if last is None else seconds(stamp - last.stamp)
        recent = last if last is not None and 0.0 < elapsed <= KEPT_SECONDS else None
        velocity = self._velocity(fix, position, north, recent, elapsed)
        yaw = self._yaw(fix, velocity, north)
        forward, port = _in_own_axes(velocity, yaw)
        rate = 0.0 if recent is None else wrapped(yaw - recent.yaw) / elapsed
        x, y = position.tolist()
        self._last = OwnShipState(stamp, (x, y), yaw, (forward, port), rate)
        return self._last

    def _yaw(self, fix: OwnShipFix, velocity: FloatArray, north: float) -> float:
        if not math.isnan(fix.heading_deg):
            return wrapped(north - math.radians(fix.heading_deg))
        self.faults[NO_HEADING] += 1
        if np.hypot(velocity[0], velocity[1]) >= SLOW:
            return float(np.arctan2(velocity[1], velocity[0]))
        return north if self._last is None else self._last.yaw

    @staticmethod
    def _velocity(
        fix: OwnShipFix,
        position: FloatArray,
        north: float,
        recent: OwnShipState | None,
        elapsed: float,
    ) -> FloatArray:
        """Return the velocity in ``map``, m/s: as told, of the positions, or none."""
        told = vectors(np.array(fix.speed), np.array(fix.course_deg), np.array(north))
        if np.isfinite(told).all():
            return told
        if recent is None:
            return np.zeros(2)
        return np.asarray((position - np.array(recent.position)) / elapsed)


def _in_own_axes(velocity: FloatArray, yaw: float) -> tuple[float, float]:
    east, north = velocity.tolist()
    cosine, sine = math.cos(yaw), math.sin(yaw)
    return cosine * east + sine * north, cosine * north - sine * east
