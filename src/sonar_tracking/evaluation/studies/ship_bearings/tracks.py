"""Ways to locate the ship of the ship-bearings study.

Without any filter, where the rays of single seconds meet the surface; by the filter that a node
runs, second by second; and by the smoother, which knows the seconds that follow, too. None of them
looks at the GPS. What it costs that the antenna of the GPS is not where a ship's noise comes from
is told apart: the distance between them can be fitted to the GPS only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.studies.ship_bearings.data import (
    ArrayBearings,
    JoinedBearings,
    join_bearings,
)
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.batch.direction_smoother import (
    DirectionSmootherConfiguration,
    smooth_directions,
    systematic_covariance,
)
from sonar_tracking.tma.estimators.range_bank import update_range_banks
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.recursion import estimate_of
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement

CONFIGURATION = RangeBankConfiguration(
    minimum_range=50.0,
    maximum_range=4000.0,
    n_ranges=4,
    maximum_speed=8.0,
    acceleration=0.03,
    manoeuvre_acceleration=0.1,
    weave_probability=0.0,
    wander_probability=0.0,
    learn_errors=False,
)
"""A ship that keeps turning, seen from the sea floor; what lasts of the errors is added afterwards,
since bearings of several arrays go into one filter."""

SMOOTHER = DirectionSmootherConfiguration(maximum_speed=8.0, systematic_deviation_deg=0.7)
"""What does not average out is what the two arrays disagree by over a minute: 0.7 deg."""

FIXES, GATED = "rays of single seconds", ", outliers taken out"
CROSS, SINGLE, BOTH = "azimuths of both arrays", "azimuth and elevation", "everything"
MINIMUM_CROSSING = 0.02
"""Sine of the least angle at which azimuths cross."""

SMOOTHED, ANTENNA = "smoothed: ", "antenna fitted: "
"""How the names of smoothed tracks begin, and of those referred to the antenna of the GPS."""


@dataclass(frozen=True)
class ShipTrack:
    """Located ship.

    Attributes
    ----------
    system, arrays : str
        How, and by which arrays.
    times : ndarray, shape (n,)
        s.
    position, ship : ndarray, shape (n, 2)
        Located and true, m.
    nees : ndarray, shape (n,)
        Of the position, per dimension, pure numbers; NaN = no covariance.
    antenna : float
        How far the antenna is ahead of the noise, fitted to the GPS, m; NaN = not fitted.
    instants : int
        At which there could have been a confirmed row; 0 = rows are not confirmed.
    coasted : ndarray of bool, shape (n,), or None
        Which positions are predicted since the ship is not heard; None = none.
    """

    system: str
    arrays: str
    times: FloatArray
    position: FloatArray
    ship: FloatArray
    nees: FloatArray
    antenna: float = np.nan
    instants: int = 0
    coasted: BoolArray | None = None


def locate_ship(arrays: tuple[ArrayBearings, ...]) -> tuple[ShipTrack, ...]:
    """Return the tracks of all ways to locate the ship.

    Parameters
    ----------
    arrays : tuple of ArrayBearings
        What was measured.
    """
    ways = [(SINGLE, join_bearings((array,), elevations=True)) for array in arrays]
    if len(arrays) > 1:
        ways.append((CROSS, join_bearings(arrays, elevations=False)))
        ways.append((BOTH, join_bearings(arrays, elevations=True)))
    estimates = _filtered([joined for _, joined in ways])
    tracked = [
        _tracked(system, joined, own) for (system, joined), own in zip(ways, estimates, strict=True)
    ]
    tracks: list[ShipTrack] = []
    for array, of_array in zip(arrays, tracked, strict=False):
        fixes = fix_single_seconds(array)
        tracks += [fixes, _consistent(fixes, array), *of_array]
    if len(arrays) > 1:
        tracks.append(cross_fixes(arrays[0], arrays[1]))
        tracks += [track for of_both in tracked[len(arrays) :] for track in of_both]
    return tuple(tracks)


def fix_single_seconds(array: ArrayBearings) -> ShipTrack:
    """Return where the ray of each second meets the surface; NaN where it never does.

    Parameters
    ----------
    array : ArrayBearings
        What was measured.
    """
    slope = np.where(array.elevation > 0.0, np.tan(array.elevation), np.nan)
    distance = -array.position[2] / slope
    direction = np.stack([np.cos(array.azimuth), np.sin(array.azimuth)], axis=1)
    position = array.position[:2] + distance[:, None] * direction
    unknown = np.full(len(distance), np.nan)
    return ShipTrack(FIXES, array.name, array.times, position, array.ship, unknown)


def cross_fixes(first: ArrayBearings, second: ArrayBearings) -> ShipTrack:
    """Return where the azimuths of two arrays cross, both consistent and within a second.

    Parameters
    ----------
    first, second : ArrayBearings
        What was measured.
    """
    own, others = np.flatnonzero(first.consistent), np.flatnonzero(second.consistent)
    nearest = np.abs(first.times[own, None] - second.times[None, others]).argmin(axis=1)
    together = np.abs(first.times[own] - second.times[others[nearest]]) < 1.0
    one, other = own[together], others[nearest[together]]
    direction = [
        np.stack([np.cos(array.azimuth[rows]), np.sin(array.azimuth[rows])], axis=1)
        for array, rows in ((first, one), (second, other))
    ]
    base = second.position[:2] - first.position[:2]
    across = direction[0][:, 0] * direction[1][:, 1] - direction[0][:, 1] * direction[1][:, 0]
    along = base[0] * direction[1][:, 1] - base[1] * direction[1][:, 0]
    distance = along / np.where(np.abs(across) > MINIMUM_CROSSING, across, np.nan)
    position = first.position[:2] + distance[:, None] * direction[0]
    names = f"{first.name} and {second.name}"
    unknown = np.full(len(one), np.nan)
    times, ship = first.times[one], first.ship[one]
    return ShipTrack(f"{CROSS}{GATED}", names, times, position, ship, unknown)


def _consistent(fixes: ShipTrack, array: ArrayBearings) -> ShipTrack:
    """Return the fixes of the seconds whose delays are consistent."""
    rows = array.consistent
    return replace(
        fixes,
        system=FIXES + GATED,
        times=fixes.times[rows],
        position=fixes.position[rows],
        ship=fixes.ship[rows],
        nees=fixes.nees[rows],
    )


def measurement_of(joined: JoinedBearings, index: int) -> TmaMeasurement:
    """Return one bearing as the filter takes it.

    Parameters
    ----------
    joined : JoinedBearings
        What was measured.
    index : int
        Which.
    """
    history = joined.history
    return TmaMeasurement(
        stamp=nanoseconds(float(history.times[index])),
        position=history.position[index],
        velocity=np.zeros(2),
        azimuth=history.azimuth[index : index + 1],
        azimuth_variance=np.array(joined.azimuth_deviation[index] ** 2),
        elevation=np.array(history.elevation[index]),
        elevation_variance=np.array(history.deviation[index] ** 2),
        height=float(history.height[index]),
    )


def _filtered(joined: Sequence[JoinedBearings]) -> list[list[TmaEstimate]]:
    """Return what a filter of each makes of its bearings; all take in at once what is of one time.

    The filters know nothing of each other: together they only cost less.
    """
    stamps = [[nanoseconds(float(time)) for time in one.history.times] for one in joined]
    states: list[RangeBankState | None] = [None for _ in joined]
    estimates: list[list[TmaEstimate]] = [[] for _ in joined]
    while pending := [own for own in range(len(joined)) if len(estimates[own]) < len(stamps[own])]:
        following = {own: stamps[own][len(estimates[own])] for own in pending}
        now = [own for own in pending if following[own] == min(following.values())]
        measured = [measurement_of(joined[own], len(estimates[own])) for own in now]
        updates = update_range_banks([states[own] for own in now], measured, CONFIGURATION)
        for own, measurement, done in zip(now, measured, updates, strict=True):
            states[own] = done.state
            estimates[own].append(
                estimate_of(
                    done.state.bank, measurement, done.reborn, done.manoeuvre, done.restarted
                )
            )
    return estimates


def _tracked(
    system: str, joined: JoinedBearings, estimates: Sequence[TmaEstimate]
) -> tuple[ShipTrack, ...]:
    """Return the track of the filter, that of the smoother, and the latter at the antenna."""
    mean = np.stack([one.mean for one in estimates])
    covariance = np.stack([one.covariance for one in estimates])
    systematic = float(np.radians(SMOOTHER.systematic_deviation_deg))
    covariance[:, :2, :2] += systematic_covariance(joined.history, mean[:, :2], systematic)
    filtered = _track(system, joined, mean[:, :2], covariance)
    path = smooth_directions(joined.history, mean[:, :2], SMOOTHER)
    smoothed = _track(SMOOTHED + system, joined, path.mean[:, :2], path.covariance)
    speed = np.maximum(np.hypot(path.mean[:, 2], path.mean[:, 3]), 1e-3)
    ahead = path.mean[:, 2:] / speed[:, None]
    antenna = float(np.nanmedian(np.sum((joined.ship - path.mean[:, :2]) * ahead, axis=1)))
    at_antenna = path.mean[:, :2] + antenna * ahead
    fitted = _track(ANTENNA + system, joined, at_antenna, path.covariance)
    return filtered, smoothed, replace(fitted, antenna=antenna)


def _track(
    system: str, joined: JoinedBearings, position: FloatArray, covariance: FloatArray
) -> ShipTrack:
    error = position - joined.ship
    solved = np.linalg.solve(covariance[:, :2, :2], error[..., None])[..., 0]
    nees = 0.5 * np.sum(error * solved, axis=1)
    return ShipTrack(system, joined.names, joined.history.times, position, joined.ship, nees)
