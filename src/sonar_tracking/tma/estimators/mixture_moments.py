"""Mean and covariance of the mixture that a bank of hypotheses is."""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank


def mixture_moments(bank: HypothesisBank) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of the mixture, with the spread of the means.

    Returns
    -------
    mean : ndarray, shape (..., 4 + n_lines)
        m, m/s and Hz.
    covariance : ndarray, shape (..., 4 + n_lines, 4 + n_lines)
        In the same units squared.
    """
    weight = np.exp(bank.log_weight)
    mean = weighted_sum(weight, bank.mean)
    deviation = bank.mean - mean[..., None, :]
    return mean, weighted_sum(weight, bank.covariance) + spread_of_means(weight, deviation)


def weighted_sum(weight: FloatArray, values: FloatArray) -> FloatArray:
    """Return the sum over components: a product of matrices, which is faster than a general sum.

    Parameters
    ----------
    weight : ndarray, shape (..., n_components)
        Pure numbers.
    values : ndarray, shape (..., n_components, any further dimensions)
        In any unit.

    Returns
    -------
    ndarray, shape (..., any further dimensions)
        In the unit of the values.
    """
    further = values.shape[weight.ndim :]
    flat = values.reshape(*weight.shape, math.prod(further))
    return np.asarray((weight[..., None, :] @ flat).reshape(*weight.shape[:-1], *further))


def spread_of_means(weight: FloatArray, deviation: FloatArray) -> FloatArray:
    """Return the covariance that deviations from a mean have between components.

    Parameters
    ----------
    weight : ndarray, shape (..., n_components)
        Pure numbers.
    deviation : ndarray, shape (..., n_components, n)
        In the units of the state.

    Returns
    -------
    ndarray, shape (..., n, n)
        In these units squared.
    """
    return np.asarray(np.swapaxes(weight[..., None] * deviation, -1, -2) @ deviation)
