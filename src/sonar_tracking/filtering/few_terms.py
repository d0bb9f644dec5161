"""Sums of a few terms each, of many: of motion modes, of levels.

numpy reduces a short axis sum by sum, which takes several times longer than to add whole columns.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.records.arrays import FloatArray


def sum_of_few(values: FloatArray, axis: int) -> FloatArray:
    """Return the sums over a short axis, the terms added in their order: the bits of numpy's sum.

    Parameters
    ----------
    values : ndarray, shape (..., n_terms, ...)
        In any unit; one to seven terms.
    axis : int
        Of the terms.

    Returns
    -------
    ndarray, shape (..., ...)
        In the unit of the values.
    """
    before: tuple[Any, ...] = (slice(None),) * (axis % values.ndim)
    first: FloatArray = values[(*before, 0)]
    total = np.array(first)
    for term in range(1, values.shape[axis]):
        total += values[(*before, term)]
    return total
