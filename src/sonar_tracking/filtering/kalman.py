"""Linear Kalman filter over any number of independent targets and runs at once.

The leading dimensions ``...`` are a batch: targets, Monte Carlo runs, or both. Covariances are
updated in Joseph's form, which keeps them symmetric and positive for any gain.
Bar-Shalom, Li, Kirubarajan (2001), "Estimation with applications to tracking", section 5.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class KalmanState:
    """Gaussian state.

    Attributes
    ----------
    mean : ndarray, shape (..., n)
        State mean, in any units.
    covariance : ndarray, shape (..., n, n)
        State covariance, in the same units squared.
    """

    mean: FloatArray
    covariance: FloatArray


@dataclass(frozen=True)
class KalmanUpdate:
    """Result of a measurement update.

    Attributes
    ----------
    state : KalmanState
        Updated state.
    innovation : ndarray, shape (..., m)
        Measurement minus its prediction, in units of the measurement.
    innovation_covariance : ndarray, shape (..., m, m)
        What the filter claims the innovation's covariance to be, in the same units squared.
    """

    state: KalmanState
    innovation: FloatArray
    innovation_covariance: FloatArray


def predict(state: KalmanState, transition: FloatArray, process_noise: FloatArray) -> KalmanState:
    """Return the state after one motion step.

    Parameters
    ----------
    state : KalmanState
        Before the step.
    transition : ndarray, shape (n, n) or (..., n, n)
        F, in units of the state.
    process_noise : ndarray, shape (n, n) or (..., n, n)
        Q, in units of the state squared.
    """
    mean = np.matmul(transition, state.mean[..., None])[..., 0]
    spread = np.matmul(np.matmul(transition, state.covariance), np.swapaxes(transition, -1, -2))
    return KalmanState(mean=mean, covariance=symmetrised(spread + process_noise))


def update(
    state: KalmanState, measurement: FloatArray, measurement_matrix: FloatArray, noise: FloatArray
) -> KalmanUpdate:
    """Return the state after one measurement.

    Parameters
    ----------
    state : KalmanState
        Prediction.
    measurement : ndarray, shape (..., m)
        z, in any unit.
    measurement_matrix : ndarray, shape (m, n)
        H, units of z over units of the state.
    noise : ndarray, shape (..., m, m)
        Measurement covariance R, in units of z squared.
    """
    matrix = measurement_matrix
    innovation = measurement - np.matmul(matrix, state.mean[..., None])[..., 0]
    cross = np.matmul(state.covariance, matrix.T)
    spread = np.matmul(matrix, cross) + noise
    gain = np.swapaxes(np.linalg.solve(spread, np.swapaxes(cross, -1, -2)), -1, -2)
    mean = state.mean + np.matmul(gain, innovation[..., None])[..., 0]
    remaining = np.eye(state.mean.shape[-1]) - np.matmul(gain, matrix)
    joseph = np.matmul(np.matmul(remaining, state.covariance), np.swapaxes(remaining, -1, -2))
    joseph = joseph + np.matmul(np.matmul(gain, noise), np.swapaxes(gain, -1, -2))
    updated = KalmanState(mean=mean, covariance=symmetrised(joseph))
    return KalmanUpdate(state=updated, innovation=innovation, innovation_covariance=spread)


def symmetrised(matrix: FloatArray) -> FloatArray:
    """Return the symmetric part of square matrices, shape (..., n, n), in their units."""
    total = matrix + matrix.swapaxes(-1, -2)
    total *= 0.5
    return total
