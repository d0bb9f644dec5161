"""The covariance in which the fit of an array is judged: enough snapshots for its elements."""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import is_uniform_line
from sonar_tracking.passive.sources.mdl import forward_backward_smoothed
from sonar_tracking.records.arrays import ComplexArray, FloatArray

_SNAPSHOTS_PER_ELEMENT = 2

_FEWEST_ELEMENTS = 6
_MOST_ELEMENTS = 32
"""More show no more of a smooth colour, and cost the cube."""


def judged_size(positions: FloatArray, n_snapshots: int) -> int:
    """Return how many elements the fit is judged on, 0 = too few snapshots.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    n_snapshots : int
        Snapshots in the covariance.
    """
    n_elements = len(positions)
    size = min(n_elements, _MOST_ELEMENTS, n_snapshots // _SNAPSHOTS_PER_ELEMENT)
    if size < _FEWEST_ELEMENTS or (size < n_elements and not is_uniform_line(positions)):
        return 0
    return size


def judged_covariance(covariance: ComplexArray, size: int) -> ComplexArray:
    """Return the covariance of so many elements, smoothed over the sub-arrays of a longer line.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Sample covariance, linear power.
    size : int
        Elements to judge.

    Returns
    -------
    ndarray, shape (..., size, size), complex
        Linear power.
    """
    if size == covariance.shape[-1]:
        return covariance
    return np.asarray(forward_backward_smoothed(covariance, size))
