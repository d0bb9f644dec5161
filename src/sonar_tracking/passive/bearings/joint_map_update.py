"""One filter over the bearings of all targets: maximum a posteriori (MAP) angles of a block.

The measurement is the likelihood of all angles at once, as score and information
(:mod:`sonar_tracking.passive.directions.weighted_subspace_fit`), linearised again at every iterate.
No measurement variance needs tuning, and nothing is inverted but I + J P, so that the information J
may be singular at a crossing: the prior, with the correlations that former blocks have left, then
keeps the identities apart. The state of n targets is [n angles, n rates].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict, symmetrised
from sonar_tracking.passive.directions.weighted_subspace_fit import SubspaceFit
from sonar_tracking.records.arrays import FloatArray

_ITERATIONS = 2
"""Linearisations of one block. A fit to convergence swaps targets at crossings."""


@dataclass(frozen=True)
class JointUpdate:
    """Result of a block.

    Attributes
    ----------
    state : KalmanState
        Of all targets.
    log_evidence : ndarray, shape (...)
        Log-probability of the block under the prediction, but for what does not depend on it: the
        likelihood at the estimate, less how far the prediction was off and how little it told.
    """

    state: KalmanState
    log_evidence: FloatArray


def predict_jointly(
    state: KalmanState, interval: float, density: float | FloatArray
) -> KalmanState:
    """Return the joint state after an interval.

    Parameters
    ----------
    state : KalmanState
        mean (..., 2 n), rad and rad/s, and covariance (..., 2 n, 2 n).
    interval : float
        s.
    density : float or ndarray, shape (..., n_targets)
        Spectral density of each bearing's acceleration, rad^2/s^3.
    """
    n_targets = state.mean.shape[-1] // 2
    transition = _of_all_targets(transition_matrix(interval), n_targets)
    return predict(state, transition, joint_process_noise(n_targets, interval, density))


def joint_process_noise(n_targets: int, interval: float, density: float | FloatArray) -> FloatArray:
    """Return what the covariance of [n angles, n rates] gains in an interval.

    Parameters
    ----------
    n_targets : int
        n.
    interval : float
        s.
    density : float or ndarray, shape (..., n_targets)
        Spectral density of each bearing's acceleration, rad^2/s^3.

    Returns
    -------
    ndarray, shape (..., 2 n, 2 n)
        rad^2, rad^2/s, rad^2/s^2.
    """
    noise = _of_all_targets(process_noise_matrix(1.0, interval), n_targets)
    densities = np.broadcast_to(density, (*np.shape(density)[:-1], n_targets))
    return noise * np.concatenate([densities, densities], axis=-1)[..., None]


def update_jointly(
    state: KalmanState, age: float, fit: Callable[[FloatArray], SubspaceFit]
) -> JointUpdate:
    """Return the joint state after one block, and how well it was predicted.

    Parameters
    ----------
    state : KalmanState
        Prediction: mean (..., 2 n), covariance (..., 2 n, 2 n).
    age : float
        How long before the instant of the state the middle of the block was, s.
    fit : callable
        Score and information of the block at given angles (..., n), rad, in its middle.
    """
    n_targets = state.mean.shape[-1] // 2
    identity = np.eye(n_targets)
    matrix = _of_all_targets(np.array([[1.0, -age]]), n_targets)
    cross = state.covariance @ matrix.T
    prior = matrix @ cross
    predicted = (matrix @ state.mean[..., None])[..., 0]
    angles = predicted
    for _ in range(_ITERATIONS):
        block, fitted = fit(angles), angles
        moved = (block.information @ (angles - predicted)[..., None])[..., 0]
        mixing = identity + block.information @ prior
        pull = np.linalg.solve(mixing, (block.score + moved)[..., None])
        angles = predicted + (prior @ pull)[..., 0]
    removed = cross @ np.linalg.solve(mixing, block.information @ np.swapaxes(cross, -1, -2))
    state = KalmanState(
        mean=state.mean + (cross @ pull)[..., 0],
        covariance=symmetrised(state.covariance - removed),
    )
    step, moved = angles - fitted, angles - predicted
    bend = (block.information @ step[..., None])[..., 0]
    likelihood = block.log_likelihood + ((block.score - 0.5 * bend) * step).sum(axis=-1)
    surprise = (moved * pull[..., 0]).sum(axis=-1) + np.linalg.slogdet(mixing)[1]
    return JointUpdate(state, likelihood - 0.5 * surprise)


def _of_all_targets(matrix: FloatArray, n_targets: int) -> FloatArray:
    """Return the matrix on [n angles, n rates] that acts on each [angle, rate] like ``matrix``."""
    (n_rows, n_columns), each = matrix.shape, np.arange(n_targets)
    joint = np.zeros((n_rows, n_targets, n_columns, n_targets))
    joint[:, each, :, each] = matrix
    return joint.reshape(n_rows * n_targets, n_columns * n_targets)
