"""How height and vertical speed of a target go on: an integrated Gauss-Markov process.

    dz = v dt,   dv = -v dt / tau + sqrt(2 / tau) s dw,

with s the deviation and tau the time constant of the vertical speed.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray

VERTICAL_SPEED, VERTICAL_TIME = 1.0, 60.0
"""Standard deviation of a vertical speed, m/s, and its time constant, s: of whales, divers and
submarines alike; after ten minutes without elevations the height is open by a quarter kilometre."""


def predict_vertical(
    mean: FloatArray, covariance: FloatArray, elapsed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return states and covariance after some time; height and rate are the last two states.

    Parameters
    ----------
    mean : ndarray, shape (..., n)
        m and m/s.
    covariance : ndarray, shape (..., n, n)
        Of all states; a height of variance 0 is not known yet and stays so.
    elapsed : ndarray, shape (...)
        s.
    """
    mean, covariance = mean.copy(), covariance.copy()
    known = covariance[..., -2, -2] > 0.0
    kept = np.exp(-elapsed / VERTICAL_TIME)
    moved = VERTICAL_TIME * (1.0 - kept)
    mean[..., -2] += moved * mean[..., -1]
    mean[..., -1] *= kept
    covariance[..., -2, :] += moved[..., None] * covariance[..., -1, :]
    covariance[..., -1, :] *= kept[..., None]
    covariance[..., :, -2] += moved[..., None] * covariance[..., :, -1]
    covariance[..., :, -1] *= kept[..., None]
    share = elapsed / VERTICAL_TIME
    variance = np.where(known, VERTICAL_SPEED**2, 0.0)
    along = 2.0 * share - 3.0 + 4.0 * kept - kept**2
    covariance[..., -2, -2] += variance * VERTICAL_TIME**2 * np.maximum(along, 0.0)
    between = variance * VERTICAL_TIME * (1.0 - kept) ** 2
    covariance[..., -2, -1] += between
    covariance[..., -1, -2] += between
    covariance[..., -1, -1] += variance * (1.0 - kept**2)
    return mean, covariance
