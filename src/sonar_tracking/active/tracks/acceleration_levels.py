"""From things that are fixed to boats in hard turns: modes of growing acceleration.

Nobody needs to say how fast targets are or how they turn. One mode stands still; the others move
with nearly constant velocity, disturbed by accelerations that are constant between pings and many
times larger from one mode to the next, up to 0.3 g. What a target does shows in the mode
probabilities, and the covariance of the mixture follows. Changes of mode come at rates per second,
so that the interval between pings does not matter.

What leaves its course by wind, current or the helm keeps its speed better than its course: there
the acceleration is mostly across the velocity, as far as that is known. How often targets begin to
turn is learnt, of each and of all in the scene: where none ever has, a turn is a surprise.

A turn changes a velocity by no more than twice the speed: the change in the agile mode is limited
by that of the target, and a slow ship does not jump to the contacts around it.

References
----------
Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*,
2001, sections 6.3.2 (piecewise constant white acceleration) and 11.6 (interacting models).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from sonar_tracking.filtering.few_terms import sum_of_few
from sonar_tracking.records.arrays import FloatArray

ACCELERATIONS = (0.0006, 0.012, 0.2, 3.0)
"""Of the moving modes, m/s^2: straight on, curving gently, turning as ships do, agile as boats are
(0.3 g)."""

ALONG_SHARE, TURNING_ALONG_SHARE = 0.2, 0.5
"""Of the acceleration of what curves gently, and of what turns as ships do, along its velocity
relative to across."""

COURSE_SPEED = 0.5
"""From about this speed on what curves has a course, m/s."""

LARGEST_CHANGE = 15.0
"""Of a velocity per axis, standard deviation, m/s."""

LARGEST_CHANGE_AT_REST = 1.0
"""The same of what does not move yet, m/s; with its speed it grows as that does."""

FIXED_SPEED = 0.02
"""Of what is fixed, per axis, m/s: buoys swing."""

FIXED_DRIFT = 0.02
"""Of the place of what is fixed, m/s^0.5."""

SPEED_SHARE = (0.55, 0.75, 0.75, 1.0)
"""Speed of new targets in the moving modes, relative to that of the fastest: most are slow."""

PRIOR = (0.4, 0.43, 0.05, 0.08, 0.04)
"""Of a new target: fixed, then the moving modes."""

ENDING_RATES = np.array([1 / 1600.0, 1 / 2000.0, 1 / 500.0, 1 / 3000.0, 1 / 100.0])
"""At which a mode ends by itself, 1/s. They are low: what flows back into the straight mode brings
the uncertain velocity of the others with it."""

ENDS_IN = np.array(
    [
        [0.0, 0.32, 0.1, 0.1, 0.48],
        [0.0, 0.0, 1.0, 0.0, 0.0],
        [0.01, 0.99, 0.0, 0.0, 0.0],
        [0.01, 0.5, 0.49, 0.0, 0.0],
        [0.0, 0.02, 0.0, 0.98, 0.0],
    ]
)
"""Whereto, row = mode that ends."""

STATIC = 0
"""Mode of what is fixed."""

STRAIGHT = 1
"""Mode of what goes straight on."""

FLOW = ENDING_RATES[:, None] * ENDS_IN
"""From mode to mode, 1/s."""

GENTLE = 2
"""Mode of what curves gently."""

TURNING, AGILE = 3, 4
"""Modes into which a target changes at a rate of its own."""

EXPECTED_CHANGES = np.array([0.3, 0.3])
EXPECTED_TIME = 1000.0
"""Prior of these rates in a scene, into turning and agile: as if so many changes had been seen in
so many seconds (a Gamma distribution). Where targets have turned, others are soon believed to."""

COMPANY = 3000.0
"""Time that the rates in the scene count as much as, beside what the target itself has done, s."""


@dataclass(frozen=True)
class AccelerationLevels:
    """The modes as a motion model.

    Parameters
    ----------
    initial_speed_deviation : float
        Speed per axis of a new target that moves, m/s.
    """

    initial_speed_deviation: float

    @property
    def n_modes(self) -> int:
        """Number of modes: the fixed one and the moving ones."""
        return 1 + len(ACCELERATIONS)

    @property
    def mode_prior(self) -> FloatArray:
        """Return the mode probabilities of a new target, shape (n_modes,)."""
        return np.array(PRIOR)

    @cached_property
    def speed_deviation(self) -> FloatArray:
        """Return the speed per axis of a new target in each mode, shape (n_modes,), m/s."""
        speed = np.full(self.n_modes, self.initial_speed_deviation)
        speed[0] = min(FIXED_SPEED, self.initial_speed_deviation)
        speed[1:] *= SPEED_SHARE
        return speed

    @property
    def static_mode(self) -> int:
        """Return the first mode."""
        return STATIC

    @property
    def widest_mode(self) -> int:
        """Return the agile mode."""
        return AGILE

    def transition(
        self, interval: float, entered: FloatArray, calm: FloatArray, pooled: FloatArray
    ) -> FloatArray:
        """Return Pi of each target over an interval, row = mode before.

        Parameters
        ----------
        interval : float
            s.
        entered : ndarray, shape (n, n_modes)
            How often each mode or a harder one has been entered, pure numbers.
        calm : ndarray, shape (n, n_modes)
            Time spent in moving modes calmer than each, s.
        pooled : ndarray, shape (2, n_modes) or (n, 2, n_modes)
            Both, of all confirmed targets of the scene together, pure numbers and s.

        Returns
        -------
        ndarray, shape (n, n_modes, n_modes)
            Probabilities.
        """
        changes, time = pooled[..., 0, TURNING:], pooled[..., 1, TURNING:]
        usual = (EXPECTED_CHANGES + changes) / (EXPECTED_TIME + time)
        rates = (COMPANY * usual + entered[:, TURNING:]) / (COMPANY + calm[:, TURNING:])
        flow = np.ones((len(calm), 1, 1)) * FLOW
        flow[:, STRAIGHT:TURNING, TURNING] += rates[:, :1]
        flow[:, STRAIGHT:AGILE, AGILE] += rates[:, 1:]
        leaving = sum_of_few(flow, axis=-1)
        leaves = -np.expm1(-interval * leaving)
        transition = flow * (leaves / leaving)[..., None]
        np.einsum("nii->ni", transition)[...] = 1.0 - leaves
        return transition

    def matrices(self, velocity: FloatArray, interval: float) -> FloatArray:
        """Return F of each mode: what is fixed has lost its velocity, the others keep it.

        Parameters
        ----------
        velocity : ndarray, shape (..., n_modes, 2)
            m/s; of no influence.
        interval : float
            s.

        Returns
        -------
        ndarray, shape (n_modes, 4, 4)
            The same for all targets; pure numbers, s and 1/s.
        """
        return _matrices(interval)

    def noise(self, velocity: FloatArray, interval: float) -> FloatArray:
        """Return Q of each mode over an interval.

        Parameters
        ----------
        velocity : ndarray, shape (..., n_modes, 2)
            Before it, m/s.
        interval : float
            s.

        Returns
        -------
        ndarray, shape (..., n_modes, 4, 4)
            m^2, m^2/s, m^2/s^2.
        """
        noise = np.tile(_noise(interval), (*velocity.shape[:-2], 1, 1, 1))
        agile = velocity[..., AGILE, :]
        largest = LARGEST_CHANGE_AT_REST + np.hypot(agile[..., 0], agile[..., 1])
        share = np.minimum(largest / _changes(interval)[-1], 1.0) ** 2
        noise[..., AGILE, :, :] *= share[..., None, None]
        for mode, along in ((GENTLE, ALONG_SHARE), (TURNING, TURNING_ALONG_SHARE)):
            across = np.kron(_ramp(interval), _mostly_across(velocity[..., mode, :], along))
            noise[..., mode, :, :] = _changes(interval)[mode - 1] ** 2 * across
        return noise


@lru_cache(maxsize=16)
def _matrices(interval: float) -> FloatArray:
    matrices = np.tile(np.eye(4) + interval * np.eye(4, k=2), (1 + len(ACCELERATIONS), 1, 1))
    matrices[0] = np.diag([1.0, 1.0, 0.0, 0.0])
    return _kept(matrices)


def _changes(interval: float) -> FloatArray:
    return np.minimum(np.array(ACCELERATIONS) * interval, LARGEST_CHANGE)


@lru_cache(maxsize=16)
def _noise(interval: float) -> FloatArray:
    moving = _changes(interval)[:, None, None] ** 2 * np.kron(_ramp(interval), np.eye(2))
    place, speed = FIXED_DRIFT**2 * interval, FIXED_SPEED**2
    return _kept(np.concatenate([np.diag([place, place, speed, speed])[None], moving]))


def _ramp(interval: float) -> FloatArray:
    """Return what an acceleration does to place and velocity, by change of velocity, squared."""
    gain = np.array([0.5 * interval, 1.0])
    return np.outer(gain, gain)


def _mostly_across(velocity: FloatArray, along_share: float) -> FloatArray:
    """Return the covariance of accelerations by course, relative, shape (..., 2, 2)."""
    along = velocity[..., :, None] * velocity[..., None, :]
    known = COURSE_SPEED**2 + (velocity**2).sum(axis=-1)[..., None, None]
    return np.asarray(np.eye(2) - (1.0 - along_share**2) * along / known)


def _kept(array: FloatArray) -> FloatArray:
    """Return an array that is kept for other pings, made read only."""
    array.setflags(write=False)
    return array
