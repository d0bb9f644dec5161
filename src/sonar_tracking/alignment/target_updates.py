"""What bearings and positions tell of targets, and of the arrays that measured them.

References
----------
Bar-Shalom, Li, Kirubarajan (2001), sections 10.3 (extended Kalman filter), 11.6 (its modes).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.alignment.aligned_targets import AlignedTargets, replaced
from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray

LEAST_SHARE = 1e-300
"""Of a mode: none is ever quite impossible."""

LEAST_DOUBT = 1e-3
"""About the side of a line array: with less, the likelier side is believed."""


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
    expected, derivative = bearings.expected(mean)
    variance = np.einsum("ni,nij,nj->n", derivative, covariance, derivative)
    return -bearings.innovation(expected), variance


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
    return bearings.innovation(expected), variance


def updated_if_expected(
    targets: AlignedTargets,
    bearings: Bearings,
    innovation: FloatArray,
    spread: FloatArray,
    gate: float,
) -> tuple[AlignedTargets, FloatArray]:
    """Return targets with one bearing each, where that is not too far from what is expected.

    Parameters
    ----------
    targets : AlignedTargets
        Predicted to the instant of the bearings.
    bearings : Bearings
        One a target.
    innovation, spread : ndarray, shape (n,)
        As of :func:`innovations`, rad and rad^2.
    gate : float
        Standard deviations beyond which a bearing leaves its target as it is.

    Returns
    -------
    targets : AlignedTargets
        Updated.
    log_likelihood : ndarray, shape (n,)
        Log of the density, 1/rad.
    """
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
    sight = _line_of_sight(targets, bearings)
    innovation = bearings.innovation(sight.expected)
    mean, log_density = sight.updated(targets.mean, innovation)
    mirrored = bearings.mirrored
    if mirrored is None:
        return _weighed(replace(targets, mean=mean, covariance=sight.covariance), log_density)
    # Both sides have the same gain, and leave the same covariance.
    mean_of_other, log_other = sight.updated(targets.mean, mirrored.innovation(sight.expected))
    total = np.logaddexp(log_density, log_other)
    share = np.exp(log_other - total)
    mean = np.where((share > 0.5)[..., None], mean_of_other, mean)
    updated = replace(targets, mean=mean, covariance=sight.covariance)
    either = (share > LEAST_DOUBT) & (share < 1.0 - LEAST_DOUBT)
    if np.any(either):
        half = 0.5 * wrap_angle(mirrored.azimuth - bearings.azimuth)[:, None]
        updated = _near_the_axis(targets, bearings, half, either, updated)
    return _weighed(updated, total)


def _near_the_axis(
    targets: AlignedTargets,
    bearings: Bearings,
    half: FloatArray,
    either: BoolArray,
    otherwise: AlignedTargets,
) -> AlignedTargets:
    """Return targets with a bearing of the axis, where either side may be meant.

    Its deviation is half the angle between the sides (shape (n, 1)). That error lasts as long as
    the target is there: a target that is known better than that already stays as it is.
    """
    axis = _line_of_sight(targets, bearings, half**2)
    mean, _ = axis.updated(targets.mean, wrap_angle(bearings.innovation(axis.expected) + half))
    vague = axis.spread - bearings.variance[:, None] >= 2.0 * half**2
    mean = np.where(vague[..., None], mean, targets.mean)
    covariance = np.where(vague[..., None, None], axis.covariance, targets.covariance)
    return replace(
        otherwise,
        mean=np.where(either[..., None], mean, otherwise.mean),
        covariance=np.where(either[..., None, None], covariance, otherwise.covariance),
    )


@dataclass(frozen=True)
class _LineOfSight:
    """What a bearing does to targets whatever it is, by target and mode.

    Attributes
    ----------
    expected, spread : ndarray, shape (n, n_modes)
        Azimuths as the data will tell, rad, and variances of the innovations, rad^2.
    gain : ndarray, shape (n, n_modes, d)
        m/rad, m/s/rad and pure numbers.
    covariance : ndarray, shape (n, n_modes, d, d)
        Of the updated targets, in their units squared.
    """

    expected: FloatArray
    spread: FloatArray
    gain: FloatArray
    covariance: FloatArray

    def updated(self, mean: FloatArray, innovation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return means updated by innovations, shape (n, n_modes), rad, and log densities."""
        square = innovation**2 / self.spread
        log_density = -0.5 * (square + np.log(2.0 * np.pi * self.spread))
        return mean + self.gain * innovation[..., None], log_density


def _line_of_sight(
    targets: AlignedTargets, bearings: Bearings, doubt: FloatArray | float = 0.0
) -> _LineOfSight:
    """Return what bearings do to targets whatever they are, with a variance more of doubt."""
    expected, derivative = bearings.expected(targets.mean)
    noise = bearings.variance[:, None] + doubt
    cross = np.einsum("nmij,nmj->nmi", targets.covariance, derivative)
    spread = np.einsum("nmi,nmi->nm", derivative, cross) + noise
    gain = cross / spread[..., None]
    remaining = np.eye(targets.mean.shape[-1]) - gain[..., None] * derivative[..., None, :]
    covariance = remaining @ targets.covariance @ remaining.swapaxes(-1, -2)
    covariance += noise[..., None, None] * gain[..., None] * gain[..., None, :]
    return _LineOfSight(expected, spread, gain, covariance)


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
