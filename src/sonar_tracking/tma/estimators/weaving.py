"""A target that weaves about a mean course: what a zig-zag, currents, yaw and sloppy steering are.

Its position is that of a target that goes straight, plus a deviation d that comes back to zero: on
each axis the damped oscillation

    d'' = -2 b a d' - a^2 d + white noise,

whose stationary variances are s^2 of the velocity d' and (s / a)^2 of d. Over an interval t, with
w = a sqrt(1 - b^2), e = exp(-b a t), c = cos(w t) and z = sin(w t) / w,

    [d, d'] becomes  e [[c + b a z, z], [-a^2 z, c - b a z]] [d, d']

and the noise is what keeps the stationary covariance. A random acceleration of the same size would
carry the velocity away: with bearings alone it hides the range; a deviation that is bounded does
not, it is averaged out over a few of its periods.

The first states of such a component are the position and the velocity of the target itself, so that
what is measured depends on them as in every other one; d and d' come after the lines.

References
----------
Singer, "Estimating optimal tracking filter performance for manned maneuvering targets", IEEE Trans.
Aerospace and Electronic Systems 6(4), 1970: of the acceleration, what is here of the deviation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.sensor_frame import DEVIATION, KINEMATIC


@dataclass(frozen=True)
class Weave:
    """How much and how fast a target weaves.

    Attributes
    ----------
    speed : float
        Standard deviation of the velocity about that of the mean course, each axis, m/s.
    period : float
        2 pi / a, s.
    damping : float
        b, at most 1. The smaller, the more regular: 1 = it comes back once, with no period to speak
        of.
    """

    speed: float
    period: float
    damping: float

    @property
    def stationary(self) -> FloatArray:
        """Variances of d and d', shape (2,), m^2 and m^2/s^2."""
        return self.speed**2 * np.array([(self.period / (2.0 * np.pi)) ** 2, 1.0])


def begin_weave(covariance: FloatArray, weave: Weave) -> None:
    """Let components whose deviation is nothing so far have one, in place.

    The target is where it was: what deviates is its mean course.

    Parameters
    ----------
    covariance : ndarray, shape (..., 8 + n_lines, 8 + n_lines)
        Of the states of a target that goes straight, m, m/s and Hz squared.
    weave : Weave
        The deviation.
    """
    for axis in (0, 1):
        for place, variance in zip((axis - DEVIATION, axis - 2), weave.stationary, strict=True):
            covariance[..., place, place] += variance


def move_deviation(
    mean: FloatArray, covariance: FloatArray, elapsed: FloatArray, weave: Weave
) -> None:
    """Let d change in components that have moved as if they went straight, in place.

    Parameters
    ----------
    mean : ndarray, shape (n, 8 + n_lines, ...)
        States, m, m/s and Hz, or what they depend on linearly.
    covariance : ndarray, shape (n, 8 + n_lines, 8 + n_lines)
        In the same units squared.
    elapsed : ndarray, shape (n,)
        s.
    weave : Weave
        The deviation.
    """
    step = deviation_transition(elapsed, weave)
    states = mean if mean.ndim == covariance.ndim else mean[:, :, None]
    for each in (states, covariance, covariance.swapaxes(-1, -2)):
        _change(each, step, elapsed[:, None, None])
    _add(covariance, deviation_noise(elapsed, weave))


def add_deviation(
    transition: FloatArray, noise: FloatArray, elapsed: FloatArray, weave: Weave
) -> None:
    """Let d change in a system that goes straight and has no noise of it so far, in place.

    Parameters
    ----------
    transition, noise : ndarray, shape (n, 8 + n_lines, 8 + n_lines)
        In the units of the states, m, m/s and Hz, and in these squared.
    elapsed : ndarray, shape (n,)
        s.
    weave : Weave
        The deviation.
    """
    _change(transition, deviation_transition(elapsed, weave), elapsed[:, None, None])
    _add(noise, deviation_noise(elapsed, weave))


def deviation_noise(elapsed: FloatArray, weave: Weave) -> FloatArray:
    """Return what is new of d and d' on one axis after times of shape (n,), s: shape (n, 2, 2)."""
    step, stationary = deviation_transition(elapsed, weave), np.diag(weave.stationary)
    return np.asarray(stationary - step @ stationary @ np.swapaxes(step, -1, -2))


def deviation_transition(elapsed: FloatArray, weave: Weave) -> FloatArray:
    """Return the transition of d and d' on one axis over times of shape (n,), s: (n, 2, 2)."""
    rate = 2.0 * np.pi / weave.period
    turned, damped = rate * elapsed, weave.damping * rate
    oscillation = np.sqrt(1.0 - weave.damping**2) * turned
    level, slope = np.cos(oscillation), elapsed * np.sinc(oscillation / np.pi)
    rows = [
        [level + damped * slope, slope],
        [-(rate**2) * slope, level - damped * slope],
    ]
    return np.asarray(np.moveaxis(np.exp(-damped * elapsed) * np.array(rows), -1, 0))


def _change(states: FloatArray, step: FloatArray, elapsed: FloatArray) -> None:
    """Change d, d' and with them the target; states are the second dimension, in place."""
    size = states.shape[1]
    deviation, speed = states[:, size - DEVIATION : size - 2], states[:, size - 2 :]
    (kept, carried), (pulled, slowed) = np.moveaxis(step, 0, -1)[..., None, None]
    states[:, :2] += (kept - 1.0) * deviation + (carried - elapsed) * speed
    states[:, 2:KINEMATIC] += pulled * deviation + (slowed - 1.0) * speed
    moved = kept * deviation + carried * speed
    speed[:] = pulled * deviation + slowed * speed
    deviation[:] = moved


def _add(covariance: FloatArray, noise: FloatArray) -> None:
    """Add the covariance of a change of d and d', (..., 2, 2), which changes the target alike."""
    size = covariance.shape[-1]
    for axis in (0, 1):
        places = (axis, 0), (2 + axis, 1), (size - DEVIATION + axis, 0), (size - 2 + axis, 1)
        for row, one in places:
            for column, other in places:
                covariance[..., row, column] += noise[..., one, other]
