"""Bearing tracks as they would go on if nothing else were known of their targets.

A trial that a bearing track and a position are of one target is weighed against this: an angle that
may be anywhere, a rate as targets have them, both learnt from the same bearings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.records.arrays import FloatArray, IndexArray

RATE_DEVIATION = float(np.radians(0.15))
"""Of the rate of a bearing of which nothing is known, rad/s: 8 m/s across at 3 km."""

ANGULAR_ACCELERATION = 2e-9
"""Density of the white angular acceleration, rad^2/s^3."""

ANYWHERE = 1.0 / (2.0 * np.pi)
"""Density of a first bearing, 1/rad."""


WILD_SHARE = 0.01
"""Of the measurements may be from anywhere: one outlier decides nothing."""


@dataclass(frozen=True)
class LoneBearings:
    """One row a bearing track.

    Attributes
    ----------
    mean : ndarray, shape (n, 2)
        Angle and rate, rad and rad/s; NaN = no bearing so far.
    covariance : ndarray, shape (n, 2, 2)
        rad^2, rad^2/s, rad^2/s^2.
    """

    mean: FloatArray
    covariance: FloatArray

    def __len__(self) -> int:
        """Return the number of bearing tracks."""
        return len(self.mean)

    def rows(self, rows: IndexArray | slice) -> LoneBearings:
        """Return some of them, in the order given; shape (n_chosen,)."""
        return LoneBearings(self.mean[rows], self.covariance[rows])


def unheard(count: int) -> LoneBearings:
    """Return bearing tracks without a bearing so far."""
    return LoneBearings(np.full((count, 2), np.nan), np.full((count, 2, 2), np.nan))


def joined_bearings(*groups: LoneBearings) -> LoneBearings:
    """Return the bearing tracks of all groups, one group after the other."""
    if len(groups) == 1:
        return groups[0]
    return LoneBearings(
        np.concatenate([group.mean for group in groups]),
        np.concatenate([group.covariance for group in groups]),
    )


def predicted_bearings(bearings: LoneBearings, interval: float) -> LoneBearings:
    """Return bearing tracks an interval (s) later."""
    if not len(bearings):
        return bearings
    transition = transition_matrix(interval)
    noise = process_noise_matrix(ANGULAR_ACCELERATION, interval)
    covariance = transition @ bearings.covariance @ transition.T + noise
    return LoneBearings(bearings.mean @ transition.T, covariance)


def heard(bearings: LoneBearings, measured: Bearings) -> tuple[LoneBearings, FloatArray]:
    """Return bearing tracks with one bearing more each, and how likely it was.

    Parameters
    ----------
    bearings : LoneBearings
        Predicted to the instant of the bearings.
    measured : Bearings
        One a bearing track. Of two sides the nearer one is taken in, and both are likely.

    Returns
    -------
    bearings : LoneBearings
        Updated.
    log_likelihood : ndarray, shape (n,)
        Log of the density, 1/rad.
    """
    new = np.isnan(bearings.mean[:, 0])
    variance = measured.variance
    innovation = np.where(new, 0.0, measured.innovation(bearings.mean[:, 0]))
    spread = np.where(new, 1.0, bearings.covariance[:, 0, 0] + variance)
    density = _log_density(innovation, spread)
    mirrored = measured.mirrored
    if mirrored is not None:
        other = np.where(new, 0.0, mirrored.innovation(bearings.mean[:, 0]))
        density = np.logaddexp(density, _log_density(other, spread))
        innovation = np.where(np.abs(other) < np.abs(innovation), other, innovation)
    gain = bearings.covariance[:, :, 0] / spread[:, None]
    mean = bearings.mean + gain * innovation[:, None]
    reduction = gain[:, :, None] * gain[:, None, :] * spread[:, None, None]
    covariance = bearings.covariance - reduction
    mean[new] = np.stack([measured.azimuth[new], np.zeros(np.sum(new))], axis=-1)
    covariance[new] = 0.0
    covariance[new, 0, 0] = variance[new]
    covariance[new, 1, 1] = RATE_DEVIATION**2
    return LoneBearings(mean, covariance), np.where(new, np.log(ANYWHERE), density)


def _log_density(innovation: FloatArray, spread: FloatArray) -> FloatArray:
    return np.asarray(-0.5 * (innovation**2 / spread + np.log(2.0 * np.pi * spread)))


def guarded(log_density: FloatArray, anywhere: float = ANYWHERE) -> FloatArray:
    """Return logs of densities in which some measurements may be from anywhere.

    Parameters
    ----------
    log_density : ndarray, shape (n,)
        Of measurements that are not; 1/rad, or 1/m^2 of positions.
    anywhere : float
        Density of those that are, in the same unit.

    Returns
    -------
    ndarray, shape (n,)
        In the same unit.
    """
    likely = np.log1p(-WILD_SHARE) + log_density
    return np.asarray(np.logaddexp(likely, np.log(WILD_SHARE * anywhere)))
