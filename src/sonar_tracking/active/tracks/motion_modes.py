"""Straight, turning left, turning right: the motion of a target of known lateral acceleration.

    Omega = 0, +a_m / |v|, -a_m / |v|,

with v the velocity. Position and velocity gain white noise through G = [T^2/2 I; T I].

References
----------
Kim, Song (2007), equations 1-2 (the speed under the root is printed as the position there).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from sonar_tracking.records.arrays import FloatArray

SMALLEST_SPEED = 0.3
"""Below it the turn rate does not grow any more, m/s."""

TURN_DIRECTIONS = np.array([0.0, 1.0, -1.0])
"""Straight, left, right; the first one alone is nearly constant velocity."""


@dataclass(frozen=True)
class MotionModes:
    """Motion model of a target.

    Attributes
    ----------
    n_modes : int
        1 = nearly constant velocity, 3 = with turns.
    acceleration_deviation : float
        Of the white noise, m/s^2.
    lateral_acceleration : float
        a_m of the turns, m/s^2.
    turn_probability : float
        That a straight target turns at the next ping, to either side.
    stay_probability : float
        That a turn lasts another ping.
    initial_speed_deviation : float
        Speed per axis of a new target, m/s.
    """

    n_modes: int
    acceleration_deviation: float
    lateral_acceleration: float = 0.01
    turn_probability: float = 0.01
    stay_probability: float = 0.9
    initial_speed_deviation: float = field(kw_only=True)

    @property
    def speed_deviation(self) -> FloatArray:
        """Return the speed per axis of a new target in each mode, shape (n_modes,), m/s."""
        return np.full(self.n_modes, self.initial_speed_deviation)

    @property
    def static_mode(self) -> None:
        """Return that there is none: what is fixed is not told from what moves slowly."""
        return None

    @property
    def widest_mode(self) -> None:
        """Return that there is none: gates are those of the mixture, as published."""
        return None

    def transition(
        self, interval: float, entered: FloatArray, calm: FloatArray, pooled: FloatArray
    ) -> FloatArray:
        """Return Pi, row = mode before: the same for all targets, pings and intervals.

        Parameters
        ----------
        interval : float
            s.
        entered, calm : ndarray, shape (n, n_modes)
            Pure numbers and s.
        pooled : ndarray, shape (2, n_modes) or (n, 2, n_modes)
            Pure numbers and s.

        Returns
        -------
        ndarray, shape (n_modes, n_modes)
            Probabilities.
        """
        return self.mode_transition

    @cached_property
    def mode_transition(self) -> FloatArray:
        """Return Pi, row = mode before, shape (n_modes, n_modes), probabilities."""
        if self.n_modes == 1:
            return np.ones((1, 1))
        turn, stay = self.turn_probability, self.stay_probability
        return np.array(
            [[1.0 - turn, 0.5 * turn, 0.5 * turn], [1.0 - stay, stay, 0.0], [1.0 - stay, 0.0, stay]]
        )

    @cached_property
    def mode_prior(self) -> FloatArray:
        """Return the stationary mode probabilities, shape (n_modes,)."""
        if self.n_modes == 1:
            return np.ones(1)
        turning = 0.5 * self.turn_probability / (1.0 - self.stay_probability)
        weights = np.array([1.0, turning, turning])
        return np.asarray(weights / np.sum(weights))

    def turn_rates(self, velocity: FloatArray) -> FloatArray:
        """Return Omega of each mode.

        Parameters
        ----------
        velocity : ndarray, shape (..., n_modes, 2)
            m/s.

        Returns
        -------
        ndarray, shape (..., n_modes)
            rad/s.
        """
        speed = np.hypot(velocity[..., 0], velocity[..., 1])
        rate = self.lateral_acceleration / np.maximum(speed, SMALLEST_SPEED)
        return np.asarray(TURN_DIRECTIONS[: self.n_modes] * rate)

    def matrices(self, velocity: FloatArray, interval: float) -> FloatArray:
        """Return F of each mode over an interval.

        Parameters
        ----------
        velocity : ndarray, shape (..., n_modes, 2)
            Before it, m/s.
        interval : float
            s.

        Returns
        -------
        ndarray, shape (..., n_modes, 4, 4) or (1, 4, 4)
            Pure numbers, s and 1/s; the latter if all targets go straight.
        """
        rates = self.turn_rates(velocity) if self.n_modes > 1 else np.zeros(1)
        return turn_matrices(rates, interval)

    def noise(self, velocity: FloatArray, interval: float) -> FloatArray:
        """Return Q over an interval: the same for all modes and velocities.

        Parameters
        ----------
        velocity : ndarray, shape (..., n_modes, 2)
            m/s; of no influence.
        interval : float
            s.

        Returns
        -------
        ndarray, shape (4, 4)
            m^2, m^2/s, m^2/s^2.
        """
        return white_acceleration_noise(self.acceleration_deviation, interval)


def half_turns(rates: FloatArray, interval: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what turns are made of: half of the turn, the chord, the other half.

    A position moves along the chord, in the direction of the mean of both headings.

    Parameters
    ----------
    rates : ndarray, shape (...)
        W, rad/s.
    interval : float
        T, s.

    Returns
    -------
    chord : ndarray, shape (...)
        2 sin(W T / 2) / W, s; T at W = 0.
    cosine, sine : ndarray, shape (...)
        Of W T / 2, pure numbers.
    """
    half = 0.5 * interval * rates
    sine = np.sin(half)
    chord = np.ones(np.shape(half))
    np.divide(sine, half, out=chord, where=half != 0.0)
    chord *= interval
    return chord, np.cos(half), sine


def turn_matrices(rates: FloatArray, interval: float) -> FloatArray:
    """Return F for each turn rate.

    Parameters
    ----------
    rates : ndarray, shape (...)
        rad/s.
    interval : float
        s.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        For the state x, y, vx, vy; pure numbers, s and 1/s.
    """
    chord, half_cosine, half_sine = half_turns(rates, interval)
    matrix = np.zeros((*np.shape(rates), 4, 4))
    matrix[..., 0, 0] = matrix[..., 1, 1] = 1.0
    matrix[..., 0, 2] = matrix[..., 1, 3] = chord * half_cosine
    versine_over = chord * half_sine
    matrix[..., 0, 3] = -versine_over
    matrix[..., 1, 2] = versine_over
    matrix[..., 2, 2] = matrix[..., 3, 3] = 1.0 - 2.0 * half_sine**2
    sine = 2.0 * half_sine * half_cosine
    matrix[..., 2, 3] = -sine
    matrix[..., 3, 2] = sine
    return matrix


@lru_cache(maxsize=16)
def white_acceleration_noise(acceleration_deviation: float, interval: float) -> FloatArray:
    """Return Q = sigma^2 G G^T; read only, since it is kept.

    Parameters
    ----------
    acceleration_deviation : float
        sigma, m/s^2.
    interval : float
        s.

    Returns
    -------
    ndarray, shape (4, 4)
        m^2, m^2/s, m^2/s^2.
    """
    gain = np.kron(np.array([[0.5 * interval**2], [interval]]), np.eye(2))
    noise = np.asarray(acceleration_deviation**2 * gain @ gain.T)
    noise.setflags(write=False)
    return noise
