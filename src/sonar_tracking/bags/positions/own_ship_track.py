"""Own ship's motion from positions at some instants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.bags.tables.table_times import instant_text
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import seconds

COURSE_SPEED = 0.2
"""Slower than this the course made good says nothing of the heading, m/s."""

FASTEST = 100.0
"""Own ship between two of its positions, m/s: faster and one of them is wrong."""

LONG_GAP, MANY_STEPS = 10.0, 10.0
"""Without a position, s, from which on a gap is told; but not of a few usual steps."""

LONGEST_HELD = 60.0
"""Without a heading, s, from which on the course made good is taken; the same holds of it."""

_NAMED = 3
"""Gaps that are named; the others are counted."""


@dataclass(frozen=True)
class OwnShipMotion:
    """Own ship at the pings.

    Attributes
    ----------
    stamp : ndarray of int, shape (n,)
        ns.
    position, velocity : ndarray, shape (n, 2)
        In ``map``, m and m/s.
    azimuth, turn_rate : ndarray, shape (n,)
        Of the bow, rad (not wrapped) and rad/s.
    """

    stamp: IntArray
    position: FloatArray
    velocity: FloatArray
    azimuth: FloatArray
    turn_rate: FloatArray

    def state(self, index: int) -> OwnShipState:
        """Return the state at one ping."""
        azimuth = float(self.azimuth[index])
        cosine, sine = np.cos(azimuth), np.sin(azimuth)
        east, north = self.velocity[index]
        return OwnShipState(
            stamp=int(self.stamp[index]),
            position=(float(self.position[index, 0]), float(self.position[index, 1])),
            yaw=float(wrap_angle(azimuth)),
            velocity=(
                float(cosine * east + sine * north),
                float(cosine * north - sine * east),
            ),
            yaw_rate=float(self.turn_rate[index]),
        )


def own_ship_at(surveyed: SurveyedPositions, stamps: IntArray) -> OwnShipMotion:
    """Return own ship at the stamps of the pings, linear between the positions.

    Before the first and after the last position own ship goes on as there, which
    :func:`checked_coverage` tells. A heading missing in some lines is linear between the others;
    where none was recorded, or none for long, it is the course made good, at rest the last one.

    Parameters
    ----------
    surveyed : SurveyedPositions
        Positions, and headings or NaN.
    stamps : ndarray of int, shape (n,)
        Of the pings, ns.
    """
    first = surveyed.stamp[0]
    known, wanted = seconds(surveyed.stamp - first), seconds(stamps - first)
    position, velocity = interpolated(known, surveyed.position, wanted)
    heading, rate = interpolated(known, _azimuths(known, surveyed)[:, None], wanted)
    if surveyed.velocity is not None:
        velocity = _told_velocity(known, surveyed, wanted)
    return OwnShipMotion(stamps, position, velocity, heading[:, 0], rate[:, 0])


def _azimuths(known: FloatArray, surveyed: SurveyedPositions) -> FloatArray:
    """Return the azimuth of the bow at each position, rad, not wrapped."""
    told = np.isfinite(surveyed.azimuth)
    _, speeds = interpolated(known, surveyed.position, known)
    if not told.any():
        return _course(speeds)
    azimuth = np.interp(known, known[told], np.unwrap(surveyed.azimuth[told]))
    moving = np.hypot(speeds[:, 0], speeds[:, 1]) >= COURSE_SPEED
    lost = _headless(known, told) & moving
    if not lost.any():
        return np.asarray(azimuth)
    return np.unwrap(np.where(lost, np.arctan2(speeds[:, 1], speeds[:, 0]), azimuth))


def _headless(known: FloatArray, told: BoolArray) -> BoolArray:
    """Return at which positions (instants in s) no heading was told for long, before and after."""
    steps = np.diff(known)
    longest = max(LONGEST_HELD, MANY_STEPS * float(np.median(steps))) if len(steps) else 0.0
    times = known[told]
    after = np.searchsorted(times, known)
    before = np.where(after > 0, times[np.maximum(after - 1, 0)], -np.inf)
    behind = np.where(after < len(times), times[np.minimum(after, len(times) - 1)], np.inf)
    alone = np.minimum(known - before, behind - known)
    between = np.isfinite(before) & np.isfinite(behind)
    return ~told & (np.where(between, behind - before, alone) > longest)


def _told_velocity(
    known: FloatArray, surveyed: SurveyedPositions, wanted: FloatArray
) -> FloatArray:
    """Return velocities as told, linear between; those of the positions where they are not."""
    assert surveyed.velocity is not None
    _, made_good = interpolated(known, surveyed.position, known)
    told = np.where(np.isfinite(surveyed.velocity), surveyed.velocity, made_good)
    return np.stack([np.interp(wanted, known, column) for column in told.T], axis=1)


def check_overlap(source: str, known: IntArray, wanted: IntArray) -> None:
    """Refuse a track that has no instant in common with the data it is for.

    Parameters
    ----------
    source : str
        Where the track comes from.
    known, wanted : ndarray of int, shape (n,) and (m,)
        Instants of the track and of the data, ascending, ns.

    Raises
    ------
    ConfigurationError
        With both spans and the likely cause.
    """
    apart = seconds(int(max(known[0] - wanted[-1], wanted[0] - known[-1])))
    if apart <= 0.0:
        return
    spans = [f"{instant_text(int(t[0]))} to {instant_text(int(t[-1]))}" for t in (known, wanted)]
    raise ConfigurationError(
        f"{source} lasts from {spans[0]}, the data from {spans[1]}: they do not overlap, "
        f"{apart:.6g} s lie between them. Give times of one origin: unix_time_s in both files, or "
        "time_s in both and --epoch, the instant of time_s = 0."
    )


def checked_coverage(surveyed: SurveyedPositions, stamps: IntArray) -> list[str]:
    """Return by how much own ship is extrapolated, where it is unknown for long or leaps.

    A single position is a ship at rest, whenever it was taken.

    Parameters
    ----------
    surveyed : SurveyedPositions
        Positions of own ship.
    stamps : ndarray of int, shape (n,)
        Of the data, ascending, ns.

    Raises
    ------
    ConfigurationError
        If the positions and the data have no instant in common.
    """
    source, known = surveyed.source, surveyed.stamp
    if len(known) < 2:
        return []
    check_overlap(source, known, stamps)
    return [*_extrapolation(source, known, stamps), *_leaps(surveyed), *_without_heading(surveyed)]


def _without_heading(surveyed: SurveyedPositions) -> list[str]:
    """Return where a heading is known elsewhere, but not for long."""
    told = np.isfinite(surveyed.azimuth)
    if not told.any():
        return []
    known = seconds(surveyed.stamp - surveyed.stamp[0])
    lost = np.flatnonzero(_headless(known, told))
    if not len(lost):
        return []
    begin = instant_text(int(surveyed.stamp[lost[0]]))
    return [
        f"{surveyed.source} has no heading at {len(lost)} of {len(told)} positions for longer than "
        f"{LONGEST_HELD:g} s, first at {begin}: the course made good is taken there."
    ]


def _extrapolation(source: str, known: IntArray, stamps: IntArray) -> list[str]:
    usual = seconds(float(np.median(np.diff(known))))
    ahead = max(seconds(int(known[0] - stamps[0])), 0.0)
    after = max(seconds(int(stamps[-1] - known[-1])), 0.0)
    if max(ahead, after) <= usual:
        return []
    share = 100.0 * (ahead + after) / seconds(int(stamps[-1] - stamps[0]))
    ends = [(ahead, "begins", "after the data do"), (after, "ends", "before the data do")]
    told = " and ".join(f"{verb} {t:.6g} s {then}" for t, verb, then in ends if t > 0.0)
    return [
        f"{source} {told}: own ship is extrapolated with constant velocity for {share:.3g} % of "
        "the run; give a longer track, or check the times of both."
    ]


def _leaps(surveyed: SurveyedPositions) -> list[str]:
    """Return where the track has long gaps, and where it goes faster than a ship."""
    source, known = surveyed.source, surveyed.stamp
    steps = seconds(np.diff(known))
    notes = []
    gaps = np.flatnonzero(steps > max(LONG_GAP, MANY_STEPS * float(np.median(steps))))
    if len(gaps):
        named = [f"{steps[i]:.6g} s from {instant_text(int(known[i]))}" for i in gaps[:_NAMED]]
        more = f" and {len(gaps) - _NAMED} times more" if len(gaps) > _NAMED else ""
        notes.append(
            f"{source} has no position for {', '.join(named)}{more}: own ship is taken to go "
            "straight meanwhile."
        )
    speeds = np.hypot(*np.diff(surveyed.position, axis=0).T) / steps
    fast = np.flatnonzero(speeds > FASTEST)
    if len(fast):
        notes.append(
            f"{source} leaps in {len(fast)} of {len(steps)} steps, first at "
            f"{instant_text(int(known[fast[0]]))} with {speeds[fast[0]]:.4g} m/s; check the "
            "positions there and the unit of the times."
        )
    return notes


def interpolated(
    known: FloatArray, values: FloatArray, wanted: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return values and their rates at some times, linear between the known ones and beyond.

    Parameters
    ----------
    known : ndarray, shape (n,)
        Ascending times, s.
    values : ndarray, shape (n, k)
        At these times, in any unit.
    wanted : ndarray, shape (m,)
        Times asked for, s.

    Returns
    -------
    values, rates : ndarray, shape (m, k)
        In units of the values, and per s.
    """
    if len(known) == 1:
        return np.repeat(values, len(wanted), axis=0), np.zeros((len(wanted), values.shape[1]))
    rates = np.gradient(values, known, axis=0)
    slopes = np.diff(values, axis=0) / np.diff(known)[:, None]
    row = np.clip(np.searchsorted(known, wanted, side="right") - 1, 0, len(known) - 2)
    value = values[row] + (wanted - known[row])[:, None] * slopes[row]
    rate = np.stack([np.interp(wanted, known, column) for column in rates.T], axis=1)
    return value, rate


def _course(velocity: FloatArray) -> FloatArray:
    """Return the azimuths of velocities, at rest that before, ahead of the first that after."""
    moving = np.flatnonzero(np.hypot(velocity[:, 0], velocity[:, 1]) >= COURSE_SPEED)
    if not len(moving):
        return np.zeros(len(velocity))
    last = np.searchsorted(moving, np.arange(len(velocity)), side="right") - 1
    chosen = velocity[moving[np.maximum(last, 0)]]
    return np.unwrap(np.arctan2(chosen[:, 1], chosen[:, 0]))
