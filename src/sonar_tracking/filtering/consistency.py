"""Does a filter's covariance tell the truth? NIS, NEES and their chi-square bands.

Both statistics are given per dimension, so that a consistent filter scores 1 on average: above
the band it is optimistic, below it pessimistic.
Bar-Shalom, Li, Kirubarajan (2001), section 5.4.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray


def normalised_squared(errors: FloatArray, covariances: FloatArray) -> FloatArray:
    """Return e^T P^-1 e per dimension: NIS of innovations, NEES of estimation errors.

    Parameters
    ----------
    errors : ndarray, shape (..., n)
        Innovations, or estimates minus truth, in any unit.
    covariances : ndarray, shape (..., n, n)
        Their claimed covariances, in units of the errors squared.

    Returns
    -------
    ndarray, shape (...)
        Pure numbers, expected value 1 when the covariance is right; NaN where an error is NaN.
    """
    weighted = np.linalg.solve(covariances, errors[..., None])[..., 0]
    return np.sum(errors * weighted, axis=-1) / errors.shape[-1]


def chi_square_band(dimension: int, count: int, probability: float = 0.95) -> tuple[float, float]:
    """Return the band in which the mean of ``count`` independent statistics should lie.

    Parameters
    ----------
    dimension : int
        Dimension of each error.
    count : int
        Number of independent errors averaged.
    probability : float
        Two-sided probability of the band.

    Returns
    -------
    low, high : float
        Bounds of the mean statistic per dimension.
    """
    from scipy.special import gammaincinv  # what all of scipy.stats asks for its quantiles

    freedom = dimension * count
    tail = 0.5 * (1.0 - probability)
    low, high = 2.0 * gammaincinv(0.5 * freedom, [tail, 1.0 - tail]) / freedom
    return float(low), float(high)
