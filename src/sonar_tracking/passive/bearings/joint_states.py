"""Joint states of targets, [n angles, n rates], from and to those of each target, [angle, rate]."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState, symmetrised
from sonar_tracking.records.arrays import BoolArray, IntArray


def with_marginals(
    joint: KalmanState, before: KalmanState, after: KalmanState, rows: BoolArray
) -> KalmanState:
    """Return a joint state with other states of some targets, their correlations as they are.

    Parameters
    ----------
    joint : KalmanState
        Shapes (..., 2 n) and (..., 2 n, 2 n), rad and rad/s.
    before, after : KalmanState
        Of each target, shapes (..., n, 2) and (..., n, 2, 2), rad and rad/s.
    rows : ndarray of bool, shape (..., n)
        Targets whose state is another one.
    """
    entries = target_rows(before.mean.shape[-2])
    scale = np.linalg.cholesky(after.covariance) @ np.linalg.inv(
        np.linalg.cholesky(before.covariance)
    )
    scale = np.where(rows[..., None, None], scale, np.eye(2))
    mean, all_scales = joint.mean.copy(), np.zeros_like(joint.covariance)
    # The others keep their own account, whatever is told of them.
    mean[..., entries] = np.where(rows[..., None], after.mean, mean[..., entries])
    all_scales[..., entries[:, :, None], entries[:, None, :]] = scale
    covariance = all_scales @ joint.covariance @ np.swapaxes(all_scales, -1, -2)
    return KalmanState(mean, symmetrised(covariance))


def uncorrelated(targets: KalmanState) -> KalmanState:
    """Return the joint state of uncorrelated targets."""
    rows = target_rows(targets.mean.shape[-2])
    mean = np.empty((*targets.mean.shape[:-2], rows.size))
    covariance = np.zeros((*mean.shape, rows.size))
    mean[..., rows] = targets.mean
    covariance[..., rows[:, :, None], rows[:, None, :]] = targets.covariance
    return KalmanState(mean, covariance)


def extended(joint: KalmanState, more: KalmanState) -> KalmanState:
    """Return the joint state of two groups of targets that are uncorrelated with each other."""
    n_old, n_new = joint.mean.shape[-1] // 2, more.mean.shape[-1] // 2
    rows = target_rows(n_old + n_new)
    old, new = rows[:n_old].T.reshape(-1), rows[n_old:].T.reshape(-1)
    mean = np.empty((*joint.mean.shape[:-1], rows.size))
    covariance = np.zeros((*mean.shape, rows.size))
    for entries, part in ((old, joint), (new, more)):
        mean[..., entries] = part.mean
        covariance[..., entries[:, None], entries] = part.covariance
    return KalmanState(mean, covariance)


def each_target(joint: KalmanState) -> KalmanState:
    """Return angle and rate of each target of a joint state."""
    rows = target_rows(joint.mean.shape[-1] // 2)
    return KalmanState(
        mean=joint.mean[..., rows],
        covariance=joint.covariance[..., rows[:, :, None], rows[:, None, :]],
    )


@lru_cache(maxsize=64)
def target_rows(n_targets: int) -> IntArray:
    """Return where angle and rate of each target stand in the state, shape (n_targets, 2)."""
    rows = np.stack([np.arange(n_targets), n_targets + np.arange(n_targets)], axis=-1)
    rows.setflags(write=False)
    return rows
