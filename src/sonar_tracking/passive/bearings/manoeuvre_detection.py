"""Which bearings turn: levels of process noise, chosen by the innovations themselves.

Most bearings move steadily for minutes; a filter that allows for turns all the time knows their
rates badly, and forgets which is which while two of them cross slowly. So a bearing is taken to
move steadily until its innovations say otherwise. With the change D of an angle by an update and
the decrease of its variance by p - p', D / sqrt(p - p') is standard normal and white if the filter
is right. Its exponential mean

    m <- a m + sqrt(1 - a^2) D / sqrt(p - p'),  a = exp(-T / memory),

is then standard normal too, while a turn pushes it to one side. The level of process noise is
raised by one when m^2 exceeds a limit, and lowered by one when it falls below another. Where the
array does not resolve a bearing from another, its innovations tell nothing about turns: level and,
with even less process noise, rate from before are kept until they part.

A straight course is no steady bearing: with the angle f from the closest point of approach the
bearing accelerates by -2 b^2 tan(f), b being its rate, and f is not known. An acceleration of the
order of b^2 that lasts about 1 / b is a white one of density

    q = c |b|^3,

whatever the range and the speed; no less is taken, steady or kept. Fast bearings thus get the
process noise that their passing needs, slow ones next to none, and crossings of slow ones stay
apart by their rates.

References
----------
Y. T. Chan, A. G. C. Hu, J. B. Plant, "A Kalman filter based tracking scheme with input
estimation", IEEE Trans. AES 15(2), 1979, for the detection from innovations; Bar-Shalom, Li,
Kirubarajan (2001), section 11.2, for the switching between levels of process noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray

MEMORY = 2.5
"""Time constant of the mean innovation, s."""

HIGHEST_LEVEL = 2
"""Levels are 0 (steady), 1 and 2: the middle one follows gentle turns without much noise."""

_RAISED, _LOWERED = 9.0, 0.5
"""Limits of the squared mean innovation; one steady bearing in 370 exceeds the upper one, and the
mean of a bearing that the higher level follows well falls below the lower one soon."""

_AFTER_RAISE = 2.0
"""Size of the mean after a raise, which has explained most of it: another raise needs more."""

_PASSING_SHARE = 0.125
"""c, with which the covariances of five targets that pass and cross at 1 to 3 deg/s are right."""

_LEAST_GAIN = 1e-9


@dataclass(frozen=True)
class Manoeuvres:
    """What the innovations so far say.

    Attributes
    ----------
    deviation : ndarray, shape (..., n_targets)
        m, mean normalised innovation.
    level : ndarray of int, shape (..., n_targets)
        Level of process noise, from 0 (steady) to ``HIGHEST_LEVEL``.
    held : ndarray of bool, shape (..., n_targets)
        Whether the array did not resolve the bearing from another at the last update.
    """

    deviation: FloatArray
    level: IntArray
    held: BoolArray

    def keep(self, rows: IndexArray) -> Manoeuvres:
        """Return those of some of the targets, by their rows, shape (n_kept,)."""
        return Manoeuvres(self.deviation[..., rows], self.level[..., rows], self.held[..., rows])

    def extend(self, n_targets: int) -> Manoeuvres:
        """Return them with more targets, which move steadily."""
        shape = (*self.deviation.shape[:-1], n_targets)
        return Manoeuvres(
            np.concatenate([self.deviation, np.zeros(shape)], axis=-1),
            np.concatenate([self.level, np.zeros(shape, dtype=np.int_)], axis=-1),
            np.concatenate([self.held, np.zeros(shape, dtype=bool)], axis=-1),
        )

    def update(
        self,
        before: KalmanState,
        after: KalmanState,
        age: float,
        interval: float,
        resolved: BoolArray,
    ) -> Manoeuvres:
        """Return them after one more update.

        Parameters
        ----------
        before, after : KalmanState
            Angle and rate of each target before and after the update, shapes (..., n_targets, 2)
            and (..., n_targets, 2, 2).
        age : float
            How long before the instant of the states the angles were measured, s.
        interval : float
            Since the last update, s.
        resolved : ndarray of bool, shape (..., n_targets)
            Targets that the array tells from all others.
        """
        direction = np.array([1.0, -age])
        change = (after.mean - before.mean) @ direction
        old_variance = before.covariance @ direction @ direction
        decrease = old_variance - after.covariance @ direction @ direction
        told = resolved & (decrease > _LEAST_GAIN * old_variance)
        normalised = change / np.sqrt(np.where(told, decrease, np.inf))
        share = np.exp(-interval / MEMORY)
        mean = share * self.deviation + np.sqrt(1.0 - share**2) * normalised
        higher = told & (mean**2 > _RAISED) & (self.level < HIGHEST_LEVEL)
        lower = told & (mean**2 < _LOWERED) & (self.level > 0)
        deviation = np.where(told, mean, self.deviation)
        deviation = np.where(higher, np.copysign(_AFTER_RAISE, mean), deviation)
        return Manoeuvres(deviation, self.level + higher - lower, ~resolved)


def steady(shape: tuple[int, ...]) -> Manoeuvres:
    """Return those of targets, (..., n_targets), of which nothing has been said yet."""
    no = np.zeros(shape, dtype=bool)
    return Manoeuvres(np.zeros(shape), no.astype(np.int_), no)


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
