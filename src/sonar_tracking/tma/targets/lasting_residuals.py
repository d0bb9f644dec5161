"""How far the directions of the stations go on to be from where their target is taken to be.

Errors that never average out are hidden from a station alone: the target is taken to be where it
sees it. Stations that do not agree with each other, or with how a target can move, go on to differ
from the solution in one direction. Of each station's azimuth and elevation the mean residual of
the last minute is kept, weighed by how good each measurement is said to be,

    m = sum(w r) / sum(w),   w = exp(-age / tau) / (R + s^2),

whose variance is that of the lasting error told, s^2, of what is left of the independent ones, R,
and of the solution as seen from there. With q the sum of m^2 over these variances, n residuals and
k coordinates found from them, the variance of lasting errors is s^2 times

    max(1, (nu + q) / (nu + max(n - k, 0)))

in place of s^2: a prior of nu degrees of freedom, and no less than told.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.motion import wrapped
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.estimators.travel_time import offset_seen
from sonar_tracking.tma.targets.array_sides import RIGHT
from sonar_tracking.tma.targets.systematic_errors import NEAREST, SystematicErrors
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution

AVERAGED = 60.0
"""Time constant of the average, s."""

PRIOR_FREEDOM = 1.0
"""Degrees of freedom of what is told of lasting errors."""

WILD = 4.0
"""A residual counts at most this many standard deviations: an outlier does not last."""


@dataclass(frozen=True)
class DirectionResidual:
    """One measured direction against a solution.

    Attributes
    ----------
    value : float
        Measured less expected, rad, as an angle between lines of sight.
    white : float
        Variance told, rad^2, in the same sense.
    solution : float
        Variance of the solution as seen from there, rad^2.
    lasting : float
        Deviation of the error that lasts, rad.
    """

    value: float
    white: float
    solution: float
    lasting: float


@dataclass(frozen=True)
class _Average:
    """Sums over the residuals of one direction: weights, weighed residuals and variances."""

    weight: float
    value: float
    white: float
    newest: DirectionResidual
    stamp: int

    @property
    def mean(self) -> float:
        """Of the residuals, rad."""
        return self.value / self.weight

    @property
    def variance(self) -> float:
        """Of the mean where errors last only as long as told, rad^2."""
        white = self.white / self.weight**2
        return self.newest.lasting**2 + white + self.newest.solution


@dataclass
class LastingResiduals:
    """Of all directions of a target."""

    averages: dict[tuple[str, str], _Average] = field(default_factory=dict)

    def add(self, sensor_id: str, kind: str, residual: DirectionResidual, stamp: int) -> None:
        """Take a residual of a station's directions of a kind in, at a stamp, ns."""
        key = (sensor_id, kind)
        before = self.averages.get(key, _Average(0.0, 0.0, 0.0, residual, stamp))
        faded = math.exp(-(stamp - before.stamp) / NANOSECONDS / AVERAGED)
        spread = residual.white + residual.lasting**2
        most = WILD * math.sqrt(spread + residual.solution)
        counted = min(max(residual.value, -most), most)
        self.averages[key] = _Average(
            faded * before.weight + 1.0 / spread,
            faded * before.value + counted / spread,
            faded**2 * before.white + residual.white / spread**2,
            residual,
            stamp,
        )

    def factor(self, coordinates: int, since: int) -> float:
        """Return what the variance of lasting errors is to be multiplied by, at least 1.

        Parameters
        ----------
        coordinates : int
            Of the position, found from the directions.
        since : int
            Stamp before which directions do not count, ns.
        """
        recent = [one for one in self.averages.values() if one.stamp >= since]
        total = sum(one.mean**2 / one.variance for one in recent)
        freedom = PRIOR_FREEDOM + max(len(recent) - coordinates, 0)
        return max(1.0, (PRIOR_FREEDOM + total) / freedom)


def direction_residuals(
    observation: TargetObservation, solution: TargetSolution, errors: SystematicErrors
) -> dict[str, DirectionResidual]:
    """Return the residuals of the directions of an observation, by kind.

    Those of azimuths on the right of a line array are mirrored: one error of the cone angle has one
    sign, whichever side is the more probable at a time.

    Parameters
    ----------
    observation : TargetObservation
        With an azimuth.
    solution : TargetSolution
        After it.
    errors : SystematicErrors
        What is told of errors that last.
    """
    place = np.array(observation.position)
    offset, _ = offset_seen(solution.mean, place, observation.propagation_speed)
    distance = max(float(np.hypot(*offset)), NEAREST)
    east, north = (offset / distance).tolist()
    covariance = solution.covariance[:2, :2]
    (own_x, mixed), (_, own_y) = covariance.tolist()
    elevated = math.isfinite(observation.elevation)
    height, spatial = observation.height, solution.spatial
    if spatial is not None:
        height = float(spatial.mean[4]) - observation.sensor_z
    slant = float(np.hypot(distance, height)) if elevated else distance
    expected = math.atan2(north, east)
    apart = min((wrapped(azimuth - expected) for azimuth in observation.azimuths), key=abs)
    value = -apart if solution.side == RIGHT else apart
    flat = distance / slant
    found = {
        "azimuth": DirectionResidual(
            value * flat,
            observation.azimuth_variance * flat**2,
            (north * north * own_x - 2.0 * north * east * mixed + east * east * own_y) / slant**2,
            errors.deviation,
        )
    }
    if elevated:
        derivative = np.array([-east * height, -north * height, distance]) / slant**2
        if spatial is not None:
            own = np.ix_((0, 1, 4), (0, 1, 4))
            variance = derivative @ spatial.covariance[own] @ derivative
        else:
            variance = derivative[:2] @ covariance @ derivative[:2]
        found["elevation"] = DirectionResidual(
            observation.elevation - float(np.arctan2(height, distance)),
            observation.elevation_variance,
            float(variance),
            errors.of_elevation(abs(height) / distance),
        )
    return found
