"""Whose bearing is it: the ship-bearings study with a second ship, made up, and no labels.

Every second each array gives the directions of two ships in no order: of the real one, outliers
and quiet stretches included, and of one that is simulated, as scattered as the real ship's. Nothing
but gated likelihood tells which direction of either array is whose.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.evaluation.studies.ship_bearings.data import ArrayBearings
from sonar_tracking.evaluation.studies.ship_bearings.tracks import CONFIGURATION
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.batch.direction_smoother import MINIMUM_COSINE
from sonar_tracking.tma.estimators.mixture_moments import mixture_moments
from sonar_tracking.tma.estimators.range_bank import update_range_banks
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.stations.station_association import (
    CHANCE_DENSITY_WITH_ELEVATION,
    FREE,
    associate,
    direction_log_likelihoods,
)

SECOND_COURSE = (-1500.0, 1800.0, 0.8, 0.0)
"""East, north (m) and velocity (m/s) of the second ship at the first bearing."""

OUTLIERS = 0.1
"""Share of the second ship's bearings that are anything."""

REAL, MADE_UP = 0, 1

START_DEVIATION = float(np.radians(1.0))
"""A direction better than this may begin a target; at most two are followed."""

SILENCE = 60.0
"""A target that no direction is given to for so long ends, s."""


@dataclass(frozen=True)
class PairingResult:
    """What came of bearings without labels.

    Attributes
    ----------
    arrays : str
        Which arrays.
    error : ndarray, shape (n, 2)
        Of the real ship's and the second ship's position at every bearing, m; NaN = not known.
    right, wrong, free : int
        Bearings given to the target they are of, to the other one, and to none.
    """

    arrays: str
    error: FloatArray
    right: int
    wrong: int
    free: int


@dataclass
class _Target:
    """A target followed, and whose bearing began it (which nobody but the score knows)."""

    owner: int
    state: RangeBankState | None = None
    position: FloatArray = field(default_factory=lambda: np.full(2, np.nan))
    heard: float = -np.inf


def pair_bearings(
    arrays: tuple[ArrayBearings, ...], generator: np.random.Generator
) -> PairingResult:
    """Return how well both ships are followed from bearings without labels.

    Parameters
    ----------
    arrays : tuple of ArrayBearings
        Two or more.
    generator : numpy.random.Generator
        Of the second ship's bearings, and of the order.
    """
    scans = sorted(
        (float(time), number, index)
        for number, array in enumerate(arrays)
        for index, time in enumerate(array.times)
    )
    targets: list[_Target] = []
    errors, counts = [], np.zeros(3, dtype=int)
    for time, number, index in scans:
        array = arrays[number]
        second = _second_ship(time - scans[0][0])
        owners = generator.permutation(2)
        both = (_real(array, index), _made_up(array, index, second, generator))
        targets = [one for one in targets if time - one.heard < SILENCE]
        given = _given(targets, [both[owner] for owner in owners])
        heard: list[tuple[_Target, TmaMeasurement]] = []
        for owner, number_given in zip(owners, given, strict=True):
            if number_given == FREE:
                counts[2] += 1
                if len(targets) == 2 or array.deviation[index] > START_DEVIATION:
                    continue
                targets.append(_Target(int(owner)))
            else:
                counts[0 if targets[number_given].owner == owner else 1] += 1
            heard.append((targets[number_given], both[owner]))
        _take_in(heard, time)
        ships = np.stack([array.ship[index], second])
        errors.append([_error(targets, owner, ships[owner]) for owner in (REAL, MADE_UP)])
    names = " and ".join(array.name for array in arrays)
    right, wrong, free = (int(count) for count in counts)
    return PairingResult(names, np.array(errors), right, wrong, free)


def _take_in(heard: list[tuple[_Target, TmaMeasurement]], time: float) -> None:
    """Let targets take in a direction each, at a time in s."""
    states = [target.state for target, _ in heard]
    updates = update_range_banks(states, [one for _, one in heard], CONFIGURATION)
    for (target, _), done in zip(heard, updates, strict=True):
        target.state, target.heard = done.state, time
        target.position = mixture_moments(done.state.bank)[0][:2]


def _given(targets: list[_Target], directions: list[TmaMeasurement]) -> list[int]:
    """Return the target of each direction."""
    likelihood = np.empty((0, len(directions)))
    states = [target.state for target in targets if target.state is not None]
    if states:
        stamp = directions[0].stamp
        likelihood = direction_log_likelihoods(
            [state.bank for state in states],
            np.array([elapsed(state.stamp, stamp) for state in states]),
            CONFIGURATION.acceleration,
            directions,
            CONFIGURATION.gate,
        )
    return [int(one) for one in associate(likelihood, CHANCE_DENSITY_WITH_ELEVATION)]


def _error(targets: list[_Target], owner: int, ship: FloatArray) -> float:
    own = [np.hypot(*(one.position - ship)) for one in targets if one.owner == owner]
    return float(min(own, default=np.nan))


def _second_ship(elapsed_time: float) -> FloatArray:
    east, north, *velocity = SECOND_COURSE
    return np.array([east, north]) + elapsed_time * np.array(velocity)


def _real(array: ArrayBearings, index: int) -> TmaMeasurement:
    return _measurement(array, index, array.azimuth[index], array.elevation[index])


def _made_up(
    array: ArrayBearings, index: int, second: FloatArray, generator: np.random.Generator
) -> TmaMeasurement:
    """Return what the array would have measured of the second ship."""
    offset = second - array.position[:2]
    elevation = np.arctan2(-array.position[2], np.hypot(*offset))
    across, up = generator.standard_normal(2) * array.deviation[index]
    wild = generator.random() < OUTLIERS
    anywhere = generator.uniform((-np.pi, 0.0), (np.pi, 0.5 * np.pi))
    if wild:
        return _measurement(array, index, *anywhere)
    azimuth = np.arctan2(offset[1], offset[0]) + across / np.cos(elevation)
    return _measurement(array, index, float(wrap_angle(azimuth)), elevation + up)


def _measurement(
    array: ArrayBearings, index: int, azimuth: float, elevation: float
) -> TmaMeasurement:
    deviation = array.deviation[index]
    spread = deviation / max(abs(np.cos(elevation)), MINIMUM_COSINE)
    return TmaMeasurement(
        stamp=nanoseconds(float(array.times[index])),
        position=array.position[:2],
        velocity=np.zeros(2),
        azimuth=np.array([azimuth]),
        azimuth_variance=np.array(spread**2),
        elevation=np.array(elevation),
        elevation_variance=np.array(deviation**2),
        height=-float(array.position[2]),
    )
