"""Nearly constant velocity: the motion model of a position-like quantity and its rate.

The state is ``[value, rate]``; the acceleration is white noise of spectral density q.
Ryu, Park, Choi (2003), eqs. 1-2; Bar-Shalom, Li, Kirubarajan (2001), section 6.2.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray


def transition_matrix(interval: float) -> FloatArray:
    """Return F = [[1, T], [0, 1]], shape (2, 2), for an interval T in s."""
    return np.array([[1.0, interval], [0.0, 1.0]])


def process_noise_matrix(spectral_density: float, interval: float) -> FloatArray:
    """Return Q = q [[T^3/3, T^2/2], [T^2/2, T]].

    Parameters
    ----------
    spectral_density : float
        q, unit of the value squared per s^3.
    interval : float
        T, s.

    Returns
    -------
    ndarray, shape (2, 2)
        Covariance the motion gains during the interval: unit of the value squared, over s, over
        s^2.
    """
    squared, cubed = interval**2, interval**3
    return spectral_density * np.array([[cubed / 3.0, squared / 2.0], [squared / 2.0, interval]])


def in_plane(of_one_axis: FloatArray) -> FloatArray:
    """Return what a matrix of one axis is for both axes of a plane.

    Parameters
    ----------
    of_one_axis : ndarray, shape (2, 2)
        Of [value, rate], such as m and m/s.

    Returns
    -------
    ndarray, shape (4, 4)
        Of [x, y, rate of x, rate of y], in the same units.
    """
    matrix = np.zeros((4, 4))
    matrix[::2, ::2] = matrix[1::2, 1::2] = of_one_axis
    return matrix
