"""Is a target where a track says it may be? Beyond a fixed distance the track's own ellipse counts.

A range from bearings is uncertain by hundreds of metres when a track is first confirmed, and the
track says so: a target within its ellipse is held, however far off that is. What is not known to a
few cut-offs claims nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

ELLIPSE = 9.210
"""Squared Mahalanobis distance that holds 99 % of the errors in two dimensions."""

LARGEST_DEVIATION = 3.0
"""Cut-offs: a position less well known than this claims no target."""


def claimed(error: FloatArray, covariance: FloatArray, cutoff: float) -> NDArray[np.bool_]:
    """Return which targets lie in the ellipse of which track.

    Parameters
    ----------
    error : ndarray, shape (n_targets, n_tracks, 2)
        Positions of the tracks minus those of the targets, m.
    covariance : ndarray, shape (n_tracks, 2, 2)
        Of the tracks' positions, m^2; one that is not finite and positive definite claims nothing.
    cutoff : float
        m.
    """
    proper = np.all(np.isfinite(covariance), axis=(-2, -1))
    spread = np.linalg.eigvalsh(np.where(proper[:, None, None], covariance, np.eye(2)))
    proper &= spread[:, 0] > 1e-12 * spread[:, 1]
    proper &= spread[:, 1] <= (LARGEST_DEVIATION * cutoff) ** 2
    usable = np.where(proper[:, None, None], covariance, np.eye(2))
    square = np.sum(error * np.linalg.solve(usable, error[..., None])[..., 0], axis=-1)
    return np.asarray(proper & (square <= ELLIPSE))
