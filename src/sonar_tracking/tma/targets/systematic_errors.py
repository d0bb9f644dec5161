"""What errors of the directions of each station that never average out do to a position.

An array is never aligned exactly, and its position not known exactly: its directions have an error
that stays, that no residual of one station shows and no filter averages out. Nor is the speed of
sound the same along the path: with a relative difference b of it between target and station rays
are arcs, and an elevation e errs by (Snell's law; half of the bend between the ends of the ray)

    b / (2 sqrt(tan(e)^2 + b)),

where b below the root says that no ray is bent by more than one that just leaves the horizontal.

With derivatives J of the directions by the position and errors of deviations s of each station and
direction, a position that weighs all directions alike has the covariance

    G J^T diag(s^2) J G,   G = (J^T J)^-1,

beside its own. A position that is compared with another, of an antenna say, is off by where on the
target what is heard comes from: its variance is added, too. Where the stations do not fix a
direction at one instant, since there is but one and it measures azimuths alone, the range comes
from motion: a constant error turns the whole scene about the station, and only what is across the
line of sight counts. An elevation that a single station at rest measures fixes the range however
flat it is: nothing else does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import FloatArray

FIXED = 0.01
"""A direction in which the stations tell less than this part of the best one is not fixed."""

FIXED_ALONE = 1e-8
"""The same for a single station at rest that measures elevations: what it does not tell at all."""

NEAREST = 1.0
"""Stations are taken to be at least so far away, m."""


@dataclass(frozen=True)
class Sight:
    """From where a station observes a target.

    Attributes
    ----------
    position : tuple of float
        Of the station, m.
    z : float
        Height of the station in ``map``, m.
    height : float
        Of the target above it where that is known, m.
    elevated : bool
        Whether it measures elevations, too.
    stamp : int
        Of its last direction, ns.
    moved : bool
        Whether it has moved since the first one, so that motion may tell the range.
    """

    position: tuple[float, float]
    z: float
    height: float
    elevated: bool
    stamp: int
    moved: bool = False

    def after(self, before: Sight | None) -> Sight:
        """Return the same, following on what the station told before, if anything."""
        if before is None:
            return self
        away = np.hypot(*np.subtract(self.position, before.position))
        return replace(self, moved=before.moved or bool(away > NEAREST))


@dataclass(frozen=True)
class SystematicErrors:
    """How large the errors are that never average out.

    Attributes
    ----------
    deviation : float
        Of each direction of a station, rad.
    bending : float
        Of the speed of sound between target and station, relative: a pure number.
    size : float
        Of where on the target what is heard comes from, m.
    """

    deviation: float
    bending: float = 0.0
    size: float = 0.0

    @property
    def none(self) -> bool:
        """Whether there are no such errors."""
        return not (self.deviation or self.bending or self.size)

    def of_elevation(self, slope: float) -> float:
        """Return the deviation of an elevation, rad, whose tangent is given."""
        bent = 0.5 * self.bending / np.sqrt(slope**2 + self.bending) if self.bending else 0.0
        return float(np.hypot(self.deviation, bent))


def systematic_covariance(
    position: FloatArray,
    sights: Sequence[Sight],
    errors: SystematicErrors,
    factor: float = 1.0,
    azimuths: FloatArray | None = None,
) -> FloatArray:
    """Return the covariance that lasting errors add to that of a position.

    Parameters
    ----------
    position : ndarray, shape (2,) or (3,)
        Of the target, m; with z if its height is estimated.
    sights : sequence of Sight
        Of the stations that observe it; at least one.
    errors : SystematicErrors
        Their deviations.
    factor : float
        By which the variance of errors of directions is larger than told.
    azimuths : ndarray, shape (n_sights, n_sights), or None
        Covariance of the errors of azimuths, rad^2; None = as the deviations tell.

    Returns
    -------
    ndarray, shape (2, 2) or (3, 3)
        m^2.
    """
    moved, elevated = _displacements(position, sights)
    n_sights = len(sights)
    spread = np.zeros((n_sights + len(elevated), n_sights + len(elevated)))
    told = errors.deviation**2 * np.eye(n_sights)
    spread[:n_sights, :n_sights] = told if azimuths is None else azimuths
    for row, slope in enumerate(elevated, n_sights):
        spread[row, row] = errors.of_elevation(slope) ** 2
    added = moved @ spread @ moved.T
    return np.asarray(factor * added + errors.size**2 * np.eye(len(position)))


def displacement(position: FloatArray, sights: Sequence[Sight], turned: FloatArray) -> FloatArray:
    """Return by how much a position moves as the azimuths of stations are turned.

    Parameters
    ----------
    position : ndarray, shape (2,) or (3,)
        Of the target, m; with z if its height is estimated.
    sights : sequence of Sight
        Of the stations that observe it; at least one.
    turned : ndarray, shape (n_sights,)
        By how much, anticlockwise, rad.

    Returns
    -------
    ndarray, shape (2,) or (3,)
        m.
    """
    moved, _ = _displacements(position, sights)
    return np.asarray(moved[:, : len(sights)] @ turned)


def _displacements(position: FloatArray, sights: Sequence[Sight]) -> tuple[FloatArray, list[float]]:
    """Return how a position moves with each azimuth, then each elevation, and their tangents."""
    place = position.tolist()
    if len(sights) == 1 and len(place) == 2 and not sights[0].elevated:
        return _displacement_about(place, sights[0]), []
    rows, rises, slopes = [], [], []
    for sight in sights:
        east, north = place[0] - sight.position[0], place[1] - sight.position[1]
        distance = max(float(np.hypot(east, north)), NEAREST)
        east, north = east / distance, north / distance
        height = place[2] - sight.z if len(place) == 3 else sight.height
        slant = float(np.hypot(distance, height)) if sight.elevated else distance
        # An error across the line of sight: overhead the azimuth itself errs by more.
        rows.append([-north / slant, east / slant, 0.0][: len(place)])
        if sight.elevated:
            up = distance / slant**2
            rises.append([-east * height / slant**2, -north * height / slant**2, up][: len(place)])
            slopes.append(abs(height) / distance)
    derivative = np.array(rows + rises)
    values, vectors = np.linalg.eigh(derivative.T @ derivative)
    alone_at_rest = len(sights) == 1 and not sights[0].moved
    least = FIXED_ALONE if alone_at_rest and rises else FIXED
    fixed = values > least * values[-1]
    inverse = (vectors * np.where(fixed, 1.0 / np.where(fixed, values, 1.0), 0.0)) @ vectors.T
    return inverse @ derivative.T, slopes


def _displacement_about(place: list[float], sight: Sight) -> FloatArray:
    """Return how a position moves with the azimuth of its only station: about that, shape (2, 1).

    That is what follows from the derivatives, too, without any decomposition.
    """
    east, north = place[0] - sight.position[0], place[1] - sight.position[1]
    distance = float(np.hypot(east, north))
    scale = max(distance, NEAREST) / distance if distance else 0.0
    return np.array([[-north * scale], [east * scale]])
