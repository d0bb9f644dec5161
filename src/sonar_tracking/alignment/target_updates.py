"""What bearings and positions tell of targets, and of the arrays that measured them.

References
----------
Bar-Shalom, Li, Kirubarajan (2001), sections 10.3 (extended Kalman filter), 11.6 (its modes).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.alignment.aligned_targets import MOTION, AlignedTargets, replaced
from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IndexArray

NEAREST = 1.0
"""A target is taken to be at least so far from a station, m."""

LEAST_SHARE = 1e-300
"""Of a mode: none is ever quite impossible."""


@dataclass(frozen=True)
class Bearings:
    """Azimuths that one station measured at one instant, one a target.

    Attributes
    ----------
    azimuth, variance : ndarray, shape (n,)
        In ``map``, as the data of the station tell, rad and rad^2.
    station : ndarray, shape (2,)
        Where it is, m.
    array : int
        Which misalignment it has.
    propagation_speed : float
        Of sound, m/s; inf = targets are heard where they are.
    other_side : ndarray, shape (n,), or None
        The azimuths on the other side of a line array, rad; NaN = there is none. Near its axis
        either may be meant.
    lag : float
        By how much the stamps of the station are late, s.
    """

    azimuth: FloatArray
    variance: FloatArray
    station: FloatArray
    array: int
    propagation_speed: float = np.inf
    other_side: FloatArray | None = None
    lag: float = 0.0

    def rows(self, rows: IndexArray) -> Bearings:
        """Return some of them, in the order given; shape (n_chosen,)."""
        other = None if self.other_side is None else self.other_side[rows]
        azimuth, variance = self.azimuth[rows], self.variance[rows]
        return replace(self, azimuth=azimuth, variance=variance, other_side=other)

    @property
    def mirrored(self) -> Bearings | None:
        """The same on the other side; None = none has one. Impossible where there is none."""
        if self.other_side is None or np.all(np.isnan(self.other_side)):
            return None
        there = np.where(np.isnan(self.other_side), self.azimuth + np.pi, self.other_side)
        return replace(self, azimuth=there, other_side=None)

    def linearised(self, mean: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return innovations and their derivatives by the state.

        Parameters
        ----------
        mean : ndarray, shape (n, ..., d)
            m, m/s and rad.

        Returns
        -------
        innovation : ndarray, shape (n, ...)
            rad.
        derivative : ndarray, shape (n, ..., d)
            Of the prediction, rad/m, rad s/m and pure numbers.
        """
        offset = mean[..., :2] - self.station
        delay = self.lag + np.hypot(offset[..., 0], offset[..., 1]) / self.propagation_speed
        seen = offset - delay[..., None] * mean[..., 2:MOTION]
        square = np.maximum(np.sum(seen**2, axis=-1), NEAREST**2)
        across = np.stack([-seen[..., 1], seen[..., 0]], axis=-1) / square[..., None]
        derivative = np.zeros(mean.shape)
        derivative[..., :2] = across
        derivative[..., 2:MOTION] = -delay[..., None] * across
        derivative[..., MOTION + self.array] = -1.0
        azimuth = self.azimuth.reshape(-1, *(1,) * (mean.ndim - 2))
        expected = np.arctan2(seen[..., 1], seen[..., 0]) - mean[..., MOTION + self.array]
        return np.asarray(wrap_angle(azimuth - expected)), derivative


def expected_azimuths(
    mean: FloatArray,
    covariance: FloatArray,
    station: FloatArray,
    array: int,
    propagation_speed: float,
    lag: float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Return the azimuths that a station will tell of targets, and their variances.

    Parameters
    ----------
    mean, covariance : ndarray, shapes (n, d) and (n, d, d)
        Of the targets, m, m/s and rad, and in these units squared.
    station : ndarray, shape (2,)
        Where it is, m.
    array : int
        Which misalignment it has.
    propagation_speed : float
        Of sound, m/s.
    lag : float
        By how much the stamps of the station are late, s.

    Returns
    -------
    azimuth, variance : ndarray, shape (n,)
        rad and rad^2.
    """
    nothing = np.zeros(len(mean))
    bearings = Bearings(nothing, nothing, station, array, propagation_speed, lag=lag)
    innovation, derivative = bearings.linearised(mean)
    variance = np.einsum("ni,nij,nj->n", derivative, covariance, derivative)
    return -innovation, variance


def innovations(targets: AlignedTargets, bearings: Bearings) -> tuple[FloatArray, FloatArray]:
    """Return by how much bearings differ from what is expected, and the variance of that.

    Parameters
    ----------
    targets : AlignedTargets
        Predicted to the instant of the bearings.
    bearings : Bearings
        One a target.

    Returns
    -------
    innovation, variance : ndarray, shape (n,)
        rad and, without the errors of the bearings, rad^2.
    """
    mean, covariance = targets.collapsed()
    station, array = bearings.station, bearings.array
    speed, lag = bearings.propagation_speed, bearings.lag
    expected, variance = expected_azimuths(mean, covariance, station, array, speed, lag)
    return np.asarray(wrap_angle(bearings.azimuth - expected)), variance


def updated_if_expected(
    targets: AlignedTargets, bearings: Bearings, gate: float
) -> tuple[AlignedTargets, FloatArray]:
    """Return targets with one bearing each, where that is not too far from what is expected.

    Parameters
    ----------
    targets : AlignedTargets
        Predicted to the instant of the bearings.
    bearings : Bearings
        One a target.
    gate : float
        Standard deviations beyond which a bearing leaves its target as it is.

    Returns
    -------
    targets : AlignedTargets
        Updated.
    log_likelihood : ndarray, shape (n,)
        Log of the density, 1/rad.
    """
    innovation, spread = innovations(targets, bearings)
    near = np.flatnonzero(innovation**2 <= gate**2 * (spread + bearings.variance))
    updated, likelihood = updated_by_bearings(targets, bearings)
    return replaced(targets, near, updated.rows(near)), likelihood


def updated_by_bearings(
    targets: AlignedTargets, bearings: Bearings
) -> tuple[AlignedTargets, FloatArray]:
    """Return targets with one bearing each, and how likely each was.

    Parameters
    ----------
    targets : AlignedTargets
        Predicted to the instant of the bearings.
    bearings : Bearings
        One a target.

    Returns
    -------
    targets : AlignedTargets
        Updated.
    log_likelihood : ndarray, shape (n,)
        Log of the density, 1/rad.
    """
    near, log_density = _one_side(targets, bearings)
    mirrored = bearings.mirrored
    if mirrored is None:
        return _weighed(near, log_density)
    other, log_other = _one_side(targets, mirrored)
    total = np.logaddexp(log_density, log_other)
    share = np.exp(log_other - total)[..., None]
    apart = other.mean - near.mean
    mean = near.mean + share * apart
    within = near.covariance + share[..., None] * (other.covariance - near.covariance)
    between = (share * (1.0 - share))[..., None] * apart[..., None] * apart[..., None, :]
    return _weighed(replace(near, mean=mean, covariance=within + between), total)


def _one_side(targets: AlignedTargets, bearings: Bearings) -> tuple[AlignedTargets, FloatArray]:
    """Return targets updated by the bearings of one side, and log densities in each mode."""
    innovation, derivative = bearings.linearised(targets.mean)
    noise = bearings.variance[:, None]
    cross = np.einsum("nmij,nmj->nmi", targets.covariance, derivative)
    spread = np.einsum("nmi,nmi->nm", derivative, cross) + noise
    gain = cross / spread[..., None]
    mean = targets.mean + gain * innovation[..., None]
    remaining = np.eye(targets.mean.shape[-1]) - gain[..., None] * derivative[..., None, :]
    covariance = remaining @ targets.covariance @ remaining.swapaxes(-1, -2)
    covariance += noise[..., None, None] * gain[..., None] * gain[..., None, :]
    log_density = -0.5 * (innovation**2 / spread + np.log(2.0 * np.pi * spread))
    return replace(targets, mean=mean, covariance=covariance), log_density


def updated_by_positions(
    targets: AlignedTargets, position: FloatArray, noise: FloatArray
) -> tuple[AlignedTargets, FloatArray]:
    """Return targets with one measured position each, and how likely each was.

    Parameters
    ----------
    targets : AlignedTargets
        Predicted to the instant of the positions.
    position : ndarray, shape (n, 2)
        m.
    noise : ndarray, shape (n, 2, 2)
        m^2.

    Returns
    -------
    targets : AlignedTargets
        Updated.
    log_likelihood : ndarray, shape (n,)
        Log of the density, 1/m^2.
    """
    innovation = position[:, None] - targets.mean[..., :2]
    cross = targets.covariance[..., :2]
    spread = cross[..., :2, :] + noise[:, None]
    gain = np.linalg.solve(spread, cross.swapaxes(-1, -2)).swapaxes(-1, -2)
    mean = targets.mean + np.einsum("nmij,nmj->nmi", gain, innovation)
    remaining = np.tile(np.eye(targets.mean.shape[-1]), (*targets.mode.shape, 1, 1))
    remaining[..., :2] -= gain
    covariance = remaining @ targets.covariance @ remaining.swapaxes(-1, -2)
    covariance += gain @ noise[:, None] @ gain.swapaxes(-1, -2)
    solved = np.linalg.solve(spread, innovation[..., None])[..., 0]
    square = np.sum(innovation * solved, axis=-1)
    log_density = -0.5 * (square + np.linalg.slogdet(spread)[1]) - np.log(2.0 * np.pi)
    return _weighed(replace(targets, mean=mean, covariance=covariance), log_density)


def _weighed(targets: AlignedTargets, log_density: FloatArray) -> tuple[AlignedTargets, FloatArray]:
    """Return targets with their modes weighed by densities of shape (n, n_modes), and the sums."""
    log_weight = log_density + np.log(np.maximum(targets.mode, LEAST_SHARE))
    best = np.max(log_weight, axis=-1, keepdims=True)
    weight = np.exp(log_weight - best)
    total = np.sum(weight, axis=-1, keepdims=True)
    likelihood = np.log(total[:, 0]) + best[:, 0]
    covariance = symmetrised(targets.covariance)
    return AlignedTargets(targets.mean, covariance, weight / total), likelihood
