"""Fixed-interval smoother of a linear system with Gaussian noise, any number of rows an instant.

A Kalman filter forwards, and the recursion of Rauch, Tung and Striebel backwards.

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
from sonar_tracking.tma.batch.linear_recursion import Recursion, run_recursion


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
    run = run_recursion(
        system.start,
        (system.transition, system.noise),
        (system.matrix, system.measured, system.weight, system.variance),
    )
    return SmoothedStates(
        run.mean,
        symmetrised(run.covariance),
        run.backward @ run.covariance[1:],
        log_student(system, run),
    )


def log_student(system: LinearSystem, run: Recursion) -> float:
    """Return the logarithm of Student's t density of what was measured.

    What depends on the number of rows alone is left out.

    Parameters
    ----------
    system : LinearSystem
        What was measured.
    run : Recursion
        How well it agreed with the predictions.
    """
    freedom = system.degrees_of_freedom
    found = np.count_nonzero(system.weight, axis=-1)
    distance = 0.5 * (freedom + found) * np.log1p(run.squared / freedom)
    return float(-np.sum(np.log(run.roots)) - np.sum(distance))
