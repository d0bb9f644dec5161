"""Ships by their reports: interpolated between two of them, predicted for a short while after.

Between two reports a ship follows the cubic that has the position and the velocity of both, or the
straight line where a velocity was not told. In a long gap nothing is known of it, unless it lies
still: ships at anchor report every three minutes.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from sonar_tracking.bags.nmea.ais_reports import AisReport
from sonar_tracking.errors import InputError
from sonar_tracking.geodesy import north_azimuths, surface_positions
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.time import seconds

LONGEST_GAP = 90.0
"""Between two reports of a ship that moves, beyond which it is not known in between, s."""

LONGEST_REST = 420.0
"""The same of one that lies still, s."""

REST_SPEED = 0.5
"""Slower than this a ship lies still, m/s."""

FASTEST = 60.0
"""Of a ship between two of its reports, m/s."""

LEAP = 500.0
"""By less than this beyond it a report does not leap, m."""

FAR = "an AIS report lies farther than 200 km from the datum; it is not used"
LEAPS = (
    "an AIS report leaps from the one before it, as where two ships have one number; it is not used"
)


def vectors(speed: FloatArray, course_deg: FloatArray, north: FloatArray) -> FloatArray:
    """Return velocities in ``map``; NaN where speed, or the course of what moves, is not known.

    Parameters
    ----------
    speed : ndarray, shape (...)
        m/s.
    course_deg : ndarray, shape (...)
        From true north, deg.
    north : ndarray, shape (...)
        Azimuth of true north there, rad.

    Returns
    -------
    ndarray, shape (..., 2)
        m/s.
    """
    azimuth = north - np.radians(np.where(speed > 0.0, course_deg, 0.0))
    return np.stack([speed * np.cos(azimuth), speed * np.sin(azimuth)], axis=-1)


def report_state(report: AisReport, datum: Datum) -> FloatArray:
    """Return x, y, vx, vy of a report in ``map``, shape (4,), m and m/s."""
    place = (np.array(report.latitude_deg), np.array(report.longitude_deg))
    north = north_azimuths(*place, datum)
    velocity = vectors(np.array(report.speed), np.array(report.course_deg), north)
    return np.concatenate([surface_positions(*place, datum), velocity])


@dataclass(frozen=True)
class ShipState:
    """Where a ship is.

    Attributes
    ----------
    state : ndarray, shape (4,)
        x, y, vx, vy in ``map``, m and m/s; a velocity may be NaN.
    is_predicted : bool
        Whether no report after that instant is known.
    """

    state: FloatArray
    is_predicted: bool


@dataclass
class ShipHistory:
    """The reports of one ship.

    Attributes
    ----------
    stamps : list of int
        Ascending, ns.
    states : list of ndarray, shape (4,)
        x, y, vx, vy in ``map``, m and m/s.
    """

    stamps: list[int] = field(default_factory=list)
    states: list[FloatArray] = field(default_factory=list)
    _doubted: tuple[int, Any] | None = None

    def add(self, stamp: int, state: FloatArray) -> None:
        """Take one report; one of an instant that is known already changes nothing.

        Parameters
        ----------
        stamp : int
            ns.
        state : ndarray, shape (4,)
            x, y, vx, vy in ``map``, m and m/s; a velocity may be NaN.

        Raises
        ------
        InputError
            If the ship cannot have come there; two in a row that agree are believed.
        """
        index = bisect_right(self.stamps, stamp)
        if index and self.stamps[index - 1] == stamp:
            return
        near = self.stamps and _leaps(self.stamps[index - 1], self.states[index - 1], stamp, state)
        if near:
            doubted, self._doubted = self._doubted, (stamp, state)
            if doubted is None or _leaps(*doubted, stamp, state):
                raise InputError(LEAPS)
            self.stamps, self.states = [doubted[0]], [doubted[1]]
            index = bisect_right(self.stamps, stamp)
        self._doubted = None
        self.stamps.insert(index, stamp)
        self.states.insert(index, state)

    def at(self, stamp: int, longest_prediction: float = 0.0) -> ShipState | None:
        """Return where the ship is at an instant; None = that is not known.

        Parameters
        ----------
        stamp : int
            ns.
        longest_prediction : float
            For so long after its last report a ship that moves is predicted, s.
        """
        index = bisect_right(self.stamps, stamp) - 1
        if index < 0:
            return None
        before, elapsed = self.states[index], seconds(stamp - self.stamps[index])
        if elapsed == 0.0:
            return ShipState(before, False)
        if index + 1 == len(self.stamps):
            return _predicted(before, elapsed, longest_prediction)
        after, interval = (
            self.states[index + 1],
            seconds(self.stamps[index + 1] - self.stamps[index]),
        )
        if interval > (LONGEST_REST if _rests(before) and _rests(after) else LONGEST_GAP):
            return None
        return ShipState(_between(before, after, elapsed, interval), False)

    def forget_before(self, stamp: int) -> None:
        """Drop reports that are older than the last one before an instant, ns."""
        unneeded = max(bisect_right(self.stamps, stamp) - 1, 0)
        del self.stamps[:unneeded], self.states[:unneeded]

    def known_from_to(self) -> list[tuple[int, int]]:
        """Return from when to when the ship is known, ns; between them are gaps."""
        runs = [(self.stamps[0], self.stamps[0])]
        for before, after in pairwise(self.stamps):
            if self.at((before + after) // 2) is None:
                runs.append((after, after))
            else:
                runs[-1] = (runs[-1][0], after)
        return runs


def _rests(state: FloatArray) -> bool:
    return bool(np.hypot(state[2], state[3]) < REST_SPEED)


def _leaps(stamp: int, state: FloatArray, other: int, there: FloatArray) -> bool:
    reach = FASTEST * abs(seconds(other - stamp)) + LEAP
    return bool(np.hypot(*(there - state)[:2]) > reach)


def _predicted(state: FloatArray, elapsed: float, longest: float) -> ShipState | None:
    moves = not _rests(state)
    if longest <= 0.0 or elapsed > (longest if moves else LONGEST_REST):
        return None
    if not moves or np.isnan(state[2:]).any():
        return ShipState(state, True)
    return ShipState(np.concatenate([state[:2] + elapsed * state[2:], state[2:]]), True)


def _between(before: FloatArray, after: FloatArray, elapsed: float, interval: float) -> FloatArray:
    share = elapsed / interval
    change = after[:2] - before[:2]
    early, late = interval * before[2:] - change, interval * after[2:] - change
    if np.isnan(early + late).any():
        return np.concatenate([before[:2] + share * change, change / interval])
    bend = share * (1.0 - share) * ((1.0 - share) * early - share * late)
    slope = (1.0 - 3.0 * share) * (1.0 - share) * early - share * (2.0 - 3.0 * share) * late
    return np.concatenate([before[:2] + share * change + bend, (change + slope) / interval])
