"""Fixed-interval smoother of a linear system with Gaussian noise, any number of rows an instant.

A Kalman filter forwards in information form, so that a row of no weight need not be cut out, and
the recursion of Rauch, Tung and Striebel backwards.

References
----------
Rauch, Tung and Striebel, "Maximum likelihood estimates of linear dynamic systems", AIAA J. 3(8),
1965.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState, symmetrised
from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class LinearSystem:
    """What moves, and what was measured of it.

    Attributes
    ----------
    start : KalmanState
        Before the first instant, shapes (size,) and (size, size).
    transition, noise : ndarray, shape (n, size, size)
        Into each instant from the one before, in units of the state, and in these squared; those
        of the first one act on the start.
    matrix : ndarray, shape (n, n_rows, size)
        Measurement matrix of each instant, units of the rows over units of the state.
    measured : ndarray, shape (n, n_rows)
        In the units of the rows.
    weight : ndarray, shape (n, n_rows)
        One over the variance of each row, in units of the row squared; 0 = there is none.
    variance : ndarray, shape (n, n_rows)
        Of each row by itself, before it was weighed for being an outlier or not, in the units of
        the row squared.
    degrees_of_freedom : float
        Of the distribution that what is measured is judged by.
    """

    start: KalmanState
    transition: FloatArray
    noise: FloatArray
    matrix: FloatArray
    measured: FloatArray
    weight: FloatArray
    variance: FloatArray
    degrees_of_freedom: float


@dataclass(frozen=True)
class SmoothedStates:
    """States given everything that was measured.

    Attributes
    ----------
    mean : ndarray, shape (n, size)
        In the units of the state.
    covariance : ndarray, shape (n, size, size)
        In the same units squared.
    crossed : ndarray, shape (n - 1, size, size)
        Covariance of each state with the next one, in the units of the state squared.
    log_likelihood : float
        Of all that was measured, each instant given those before it.
    """

    mean: FloatArray
    covariance: FloatArray
    crossed: FloatArray
    log_likelihood: float


def smooth_linear(system: LinearSystem) -> SmoothedStates:
    """Return the states given everything that was measured.

    Parameters
    ----------
    system : LinearSystem
        Dynamics and measurements.
    """
    n_times, _, size = system.matrix.shape
    mean, covariance = np.empty((n_times, size)), np.empty((n_times, size, size))
    ahead_mean, ahead = np.empty_like(mean), np.empty_like(covariance)
    state, spread = system.start.mean, system.start.covariance
    log_likelihood = 0.0
    for index in range(n_times):
        transition = system.transition[index]
        state = transition @ state
        spread = transition @ spread @ transition.T + system.noise[index]
        ahead_mean[index], ahead[index] = state, spread
        there = np.flatnonzero(system.weight[index])
        if len(there):
            matrix = system.matrix[index, there]
            crossed = spread @ matrix.T
            inner = matrix @ crossed
            innovation = system.measured[index, there] - matrix @ state
            judged = inner + np.diag(system.variance[index, there])
            log_likelihood += log_student(innovation, judged, system.degrees_of_freedom)
            inner.flat[:: len(there) + 1] += 1.0 / system.weight[index, there]
            gain = np.linalg.solve(inner, crossed.T).T
            state = state + gain @ innovation
            spread = spread - gain @ crossed.T
            spread = 0.5 * (spread + spread.T)
        mean[index], covariance[index] = state, spread
    # The gains backwards do not depend on each other.
    forwards = system.transition[1:] @ covariance[:-1]
    back = np.linalg.solve(ahead[1:], forwards).swapaxes(-1, -2)
    for index in range(n_times - 2, -1, -1):
        mean[index] += back[index] @ (mean[index + 1] - ahead_mean[index + 1])
        later = covariance[index + 1] - ahead[index + 1]
        covariance[index] += back[index] @ later @ back[index].T
    return SmoothedStates(mean, symmetrised(covariance), back @ covariance[1:], log_likelihood)


def log_student(error: FloatArray, covariance: FloatArray, freedom: float) -> float:
    """Return the logarithm of Student's t density, without what depends on the size only.

    Parameters
    ----------
    error : ndarray, shape (n,)
        In any units.
    covariance : ndarray, shape (n, n)
        Scale matrix, in the same units squared.
    freedom : float
        Degrees of freedom.
    """
    root = np.linalg.cholesky(covariance)
    squared = error @ np.linalg.solve(covariance, error)
    size = len(error)
    return float(
        -np.sum(np.log(np.diagonal(root))) - 0.5 * (freedom + size) * np.log1p(squared / freedom)
    )
