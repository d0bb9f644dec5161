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
    mean: FloatArray, covariance: FloatArray, elapsed: FloatArray, place: int = -2
) -> tuple[FloatArray, FloatArray]:
    """Return states and covariance after some time.

    Parameters
    ----------
    mean : ndarray, shape (..., n)
        m and m/s.
    covariance : ndarray, shape (..., n, n)
        Of all states, m^2, m^2/s and m^2/s^2; a height of variance 0 is not known yet and stays so.
    elapsed : ndarray, shape (...)
        s.
    place : int
        Of the height in the state; its rate comes next.

    Returns
    -------
    mean : ndarray, shape (..., n)
        m and m/s.
    covariance : ndarray, shape (..., n, n)
        m^2, m^2/s and m^2/s^2.
    """
    height, rate = place, place + 1
    mean, covariance = mean.copy(), covariance.copy()
    known = covariance[..., height, height] > 0.0
    kept = np.exp(-elapsed / VERTICAL_TIME)
    moved = VERTICAL_TIME * (1.0 - kept)
    mean[..., height] += moved * mean[..., rate]
    mean[..., rate] *= kept
    covariance[..., height, :] += moved[..., None] * covariance[..., rate, :]
    covariance[..., rate, :] *= kept[..., None]
    covariance[..., :, height] += moved[..., None] * covariance[..., :, rate]
    covariance[..., :, rate] *= kept[..., None]
    share = elapsed / VERTICAL_TIME
    variance = np.where(known, VERTICAL_SPEED**2, 0.0)
    along = 2.0 * share - 3.0 + 4.0 * kept - kept**2
    covariance[..., height, height] += variance * VERTICAL_TIME**2 * np.maximum(along, 0.0)
    between = variance * VERTICAL_TIME * (1.0 - kept) ** 2
    covariance[..., height, rate] += between
    covariance[..., rate, height] += between
    covariance[..., rate, rate] += variance * (1.0 - kept**2)
    return mean, covariance
