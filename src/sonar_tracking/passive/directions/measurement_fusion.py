"""Maximum-likelihood fusion of the measurements from adjacent subspaces.

The P measurements of a target have equal variances, so that their fusion is the plain mean (eq.
13). Its variance is R / P only if they are independent (eq. 14), which they are not: neighbouring
subspaces share nearly all their snapshots. Their correlation is beta^(snapshots between them), and
the variance of the mean is (R / P^2) sum_ij beta^|n_i - n_j|, five to seven times larger.

References
----------
Ryu, Park, Choi (2003), eqs. 9-14.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.records.arrays import FloatArray


def fused_measurement(measurements: FloatArray) -> FloatArray:
    """Return the fused measurement of each target (eq. 13).

    Parameters
    ----------
    measurements : ndarray, shape (..., n_subspaces, n_targets)
        rad.

    Returns
    -------
    ndarray, shape (..., n_targets)
        rad.
    """
    return np.asarray(measurements.mean(axis=-2))


def independent_variance_ratio(n_subspaces: int) -> float:
    """Return fused variance / single variance if the measurements were independent (eq. 14)."""
    return 1.0 / n_subspaces


def correlated_variance_ratio(
    time_offsets: ArrayLike, sample_period: float, forgetting_factor: float
) -> float:
    """Return fused variance / single variance of exponentially windowed subspaces.

    Parameters
    ----------
    time_offsets : array_like, shape (n_subspaces,)
        When each subspace was taken, s.
    sample_period : float
        Between snapshots, s.
    forgetting_factor : float
        beta, per snapshot.
    """
    offsets = np.asarray(time_offsets, dtype=np.float64)
    snapshots_apart = np.abs(offsets[:, None] - offsets[None, :]) / sample_period
    return float(np.mean(forgetting_factor**snapshots_apart))


def forgetting_factor_of(effective_snapshots: float) -> float:
    """Return beta of a window that stands for (1 + beta) / (1 - beta) independent snapshots."""
    return (effective_snapshots - 1.0) / (effective_snapshots + 1.0)


def mean_age(forgetting_factor: float) -> float:
    """Return the mean age beta / (1 - beta) of the snapshots in an exponential window, snapshots.

    A target that moves is seen where it was this long ago.
    """
    return forgetting_factor / (1.0 - forgetting_factor)
