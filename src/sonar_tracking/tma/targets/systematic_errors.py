"""What a constant error of the directions of each station does to a position.

An array is never aligned exactly, and its position not known exactly: its directions have an error
that stays, that no residual of one station shows and no filter averages out. With derivatives J of
the directions by the position, and an error of deviation s of each station and direction, the
position that they fix has the covariance

    s^2 (sum J^T J)^-1

beside its own. Where the stations do not fix a direction at one instant, since there is but one
and it measures azimuths alone, the range comes from motion: a constant error turns the whole scene
about the station, and only what is across the line of sight counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray

FIXED = 0.01
"""A direction in which the stations tell less than this part of the best one is not fixed."""

NEAREST = 1.0
"""Stations are taken to be at least so far away, m."""


@dataclass(frozen=True)
class Sight:
    """From where a station observes a target.

    Attributes
    ----------
    position : tuple of float
        Of the station, m.
    height : float
        Of the target above it, m.
    elevated : bool
        Whether it measures elevations, too.
    stamp : int
        Of its last direction, ns.
    """

    position: tuple[float, float]
    height: float
    elevated: bool
    stamp: int


def systematic_covariance(
    position: FloatArray, sights: Sequence[Sight], deviation: float
) -> FloatArray:
    """Return the covariance that constant errors add to that of a position.

    Parameters
    ----------
    position : ndarray, shape (2,)
        Of the target, m.
    sights : sequence of Sight
        Of the stations that observe it; at least one.
    deviation : float
        Of the error of each direction, rad.

    Returns
    -------
    ndarray, shape (2, 2)
        m^2.
    """
    information = np.zeros((2, 2))
    for sight in sights:
        offset = position - np.array(sight.position)
        distance = max(float(np.hypot(*offset)), NEAREST)
        direction = offset / distance
        across = np.array([-direction[1], direction[0]]) / distance
        information += np.outer(across, across)
        if sight.elevated:
            rise = direction * sight.height / (distance**2 + sight.height**2)
            information += np.outer(rise, rise)
    values, vectors = np.linalg.eigh(information)
    fixed = values > FIXED * values[-1]
    scaled = np.where(fixed, 1.0 / np.where(fixed, values, 1.0), 0.0)
    return np.asarray(deviation**2 * (vectors * scaled) @ vectors.T)
