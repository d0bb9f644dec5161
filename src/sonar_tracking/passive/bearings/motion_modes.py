"""How much a bearing turns: modes of process noise side by side, weighed by the innovations.

Most bearings move steadily for minutes; a filter that allows for turns all the time knows their
rates badly. How steadily, and how long a turn may go unnoticed, depends on the scene and on how
often there are data, which nobody is told. So each bearing is followed by several filters of its
own, an interacting multiple model (IMM): they differ in the spectral density of the acceleration,
from that of a bearing that hardly ever turns to the full one of a turn, in steps of one ratio. Each
takes the measurement of the bearing by itself that is equivalent to what the block has told; how
well each has predicted it gives its probability. In the interval T a bearing changes its mode with
probability 1 - exp(-T / ``_MODE_TIME``), to any of them.

A straight course is no steady bearing: with the angle f from the closest point of approach the
bearing accelerates by -2 b^2 tan(f), b being its rate, and f is not known. An acceleration of the
order of b^2 that lasts about 1 / b is a white one of density

    q = c |b|^3,

whatever the range and the speed; no mode has less. Fast bearings thus get the process noise that
their passing needs, slow ones next to none.

To turn back from another bearing within an angle d, at a relative rate b, takes an acceleration
b^2 / d for about d / b, a density of the order of b^3 / d.

References
----------
Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with applications to tracking and
navigation", Wiley, 2001, section 11.6.6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

N_MODES = 4
"""Modes of a bearing of which it is not known how much it turns."""

_MODE_TIME = 10_000.0
"""Mean time in a mode, s."""

_MORE_TURNING = 0.2
"""Probability of each mode at the start, over that of the one that turns less."""

_PASSING_SHARE = 0.125
"""c, with which the covariances of five targets that pass and cross at 1 to 3 deg/s are right."""

_TURNING_BACK_SHARE = 0.1
"""Of b^3 / d."""

_LEAST_PROBABILITY = 1e-6


@dataclass(frozen=True)
class MotionModes:
    """Filters of each bearing by itself, one a mode.

    Attributes
    ----------
    mean : ndarray, shape (..., n_targets, n_modes, 2)
        Angle and rate, rad and rad/s.
    covariance : ndarray, shape (..., n_targets, n_modes, 2, 2)
        rad^2, rad^2/s, rad^2/s^2.
    probability : ndarray, shape (..., n_targets, n_modes)
        Of each mode, pure numbers.
    """

    mean: FloatArray
    covariance: FloatArray
    probability: FloatArray

    def keep(self, rows: IndexArray) -> MotionModes:
        """Return those of some of the targets, by their rows, shape (n_kept,)."""
        return MotionModes(
            self.mean[..., rows, :, :],
            self.covariance[..., rows, :, :, :],
            self.probability[..., rows, :],
        )

    def extend(self, others: MotionModes) -> MotionModes:
        """Return them with those of more targets."""
        return MotionModes(
            np.concatenate([self.mean, others.mean], axis=-3),
            np.concatenate([self.covariance, others.covariance], axis=-4),
            np.concatenate([self.probability, others.probability], axis=-2),
        )

    def predict(self, interval: float, densities: FloatArray) -> tuple[MotionModes, FloatArray]:
        """Return the modes after an interval, and the mean process noise of each target.

        Parameters
        ----------
        interval : float
            s.
        densities : ndarray, shape (..., n_targets, n_modes)
            Spectral density of the acceleration in each mode, rad^2/s^3.

        Returns
        -------
        modes : MotionModes
            Mixed and predicted.
        density : ndarray, shape (..., n_targets)
            rad^2/s^3.
        """
        mixed = self._mixed(interval)
        transition = transition_matrix(interval)
        noise = densities[..., None, None] * process_noise_matrix(1.0, interval)
        predicted = MotionModes(
            mixed.mean @ transition.T,
            transition @ mixed.covariance @ transition.T + noise,
            mixed.probability,
        )
        return predicted, (mixed.probability * densities).sum(axis=-1)

    def update(
        self, angle: FloatArray, variance: FloatArray, age: float, told: BoolArray
    ) -> MotionModes:
        """Return the modes after a measurement of each target by itself.

        Parameters
        ----------
        angle, variance : ndarray, shape (..., n_targets)
            Measured, rad and rad^2.
        age : float
            How long before the instant of the modes the targets had these angles, s.
        told : ndarray of bool, shape (..., n_targets)
            Targets that have a measurement; the others stay as they are.
        """
        cross = self.covariance[..., 0] - age * self.covariance[..., 1]
        predicted = cross[..., 0] - age * cross[..., 1]
        measured = np.where(told, angle, 0.0)[..., None]
        innovation = measured - (self.mean[..., 0] - age * self.mean[..., 1])
        spread = np.where(told, variance, np.inf)[..., None] + predicted
        gain = cross / spread[..., None]
        likelihood = -0.5 * (
            innovation**2 / spread + np.log(np.where(told[..., None], spread, 1.0))
        )
        likelihood -= likelihood.max(axis=-1, keepdims=True)
        probability = self.probability * np.exp(likelihood)
        probability = np.maximum(probability, _LEAST_PROBABILITY)
        return MotionModes(
            self.mean + gain * innovation[..., None],
            self.covariance - gain[..., :, None] * cross[..., None, :],
            np.where(
                told[..., None],
                probability / probability.sum(axis=-1, keepdims=True),
                self.probability,
            ),
        )

    def combined(self) -> KalmanState:
        """Return angle and rate of each target, shapes (..., n_targets, 2) and (..., 2, 2)."""
        weights = self.probability[..., None]
        mean = (weights * self.mean).sum(axis=-2)
        apart = self.mean - mean[..., None, :]
        spread = self.covariance + apart[..., :, None] * apart[..., None, :]
        return KalmanState(mean, (weights[..., None] * spread).sum(axis=-3))

    def restarted(self, targets: KalmanState, rows: BoolArray) -> MotionModes:
        """Return them with some targets in the same state in all modes.

        Parameters
        ----------
        targets : KalmanState
            Angle and rate, shapes (..., n_targets, 2) and (..., n_targets, 2, 2).
        rows : ndarray of bool, shape (..., n_targets)
            Which targets.
        """
        mean, covariance = targets.mean[..., None, :], targets.covariance[..., None, :, :]
        return MotionModes(
            np.where(rows[..., None, None], mean, self.mean),
            np.where(rows[..., None, None, None], covariance, self.covariance),
            self.probability,
        )

    def instead(self, rows: BoolArray, others: MotionModes) -> MotionModes:
        """Return them with those of some targets, by a mask, shape (..., n), from others."""
        return MotionModes(
            np.where(rows[..., None, None], others.mean, self.mean),
            np.where(rows[..., None, None, None], others.covariance, self.covariance),
            np.where(rows[..., None], others.probability, self.probability),
        )

    def _mixed(self, interval: float) -> MotionModes:
        """Return the modes with what each of them takes over from the others in an interval."""
        n_modes = self.probability.shape[-1]
        staying = np.exp(-interval / _MODE_TIME)
        change = staying * np.eye(n_modes) + (1.0 - staying) / n_modes
        flow = self.probability[..., :, None] * change
        probability = flow.sum(axis=-2)
        weights = np.swapaxes(flow / probability[..., None, :], -1, -2)
        centre = (self.probability[..., None] * self.mean).sum(axis=-2, keepdims=True)
        apart = self.mean - centre
        spread = self.covariance + apart[..., :, None] * apart[..., None, :]
        mean = weights @ apart
        second = weights @ spread.reshape(*spread.shape[:-2], 4)
        covariance = second.reshape(spread.shape) - mean[..., :, None] * mean[..., None, :]
        return MotionModes(centre + mean, covariance, probability)


def undecided(targets: KalmanState, n_modes: int) -> MotionModes:
    """Return the modes of targets of which nothing has been said yet.

    Parameters
    ----------
    targets : KalmanState
        Angle and rate, shapes (..., n_targets, 2) and (..., n_targets, 2, 2).
    n_modes : int
        Number of modes; 0 = it is known how much they turn.
    """
    shape = (*targets.mean.shape[:-1], n_modes)
    return MotionModes(
        np.broadcast_to(targets.mean[..., None, :], (*shape, 2)),
        np.broadcast_to(targets.covariance[..., None, :, :], (*shape, 2, 2)),
        np.broadcast_to(first_probabilities(n_modes), shape),
    )


def first_probabilities(n_modes: int) -> FloatArray:
    """Return the probabilities of the modes at the start, shape (n_modes,)."""
    weights = _MORE_TURNING ** np.arange(n_modes)
    return np.asarray(weights / weights.sum() if n_modes else weights, dtype=np.float64)


def mode_densities(steady: float, turning: float) -> FloatArray:
    """Return the spectral densities of the modes, shape (n_modes,), rad^2/s^3."""
    return np.asarray(np.geomspace(steady, turning, N_MODES), dtype=np.float64)


def passing_process_noise(rates: FloatArray) -> FloatArray:
    """Return the spectral density of the acceleration of bearings of targets on straight courses.

    Parameters
    ----------
    rates : ndarray, shape (..., n_targets)
        rad/s.

    Returns
    -------
    ndarray, shape (..., n_targets)
        c |rate|^3, rad^2/s^3.
    """
    return np.asarray(_PASSING_SHARE * np.abs(rates) ** 3)


def turning_back_process_noise(
    rates: FloatArray, close: BoolArray, separation: float
) -> FloatArray:
    """Return the spectral density that lets bearings near each other turn back.

    Parameters
    ----------
    rates : ndarray, shape (..., n_targets)
        rad/s.
    close : ndarray of bool, shape (..., n_targets, n_targets)
        Pairs that the array does not resolve.
    separation : float
        Angle at which it does, rad.

    Returns
    -------
    ndarray, shape (..., n_targets)
        rad^2/s^3; 0 where there is no such pair.
    """
    relative = np.abs(rates[..., :, None] - rates[..., None, :])
    fastest = np.where(close, relative, 0.0).max(axis=-1, initial=0.0)
    return np.asarray(_TURNING_BACK_SHARE * fastest**3 / separation)
