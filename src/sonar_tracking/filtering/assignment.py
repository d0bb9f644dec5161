"""Pairs of least total cost.

The solver comes with ``scipy.optimize``, which takes longer to load than a whole node to start: it
is loaded by the first assignment, or before, by :func:`load_solver`.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray, IndexArray


def least_cost_pairs(costs: FloatArray) -> tuple[IndexArray, IndexArray]:
    """Return the pairs of rows and columns whose costs have the least sum.

    Parameters
    ----------
    costs : ndarray, shape (n_rows, n_columns)
        Finite, in any unit.

    Returns
    -------
    rows, columns : ndarray of int, shape (min(n_rows, n_columns),)
        Each row and column at most once, rows rising.
    """
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(costs)
    return rows, columns


def load_solver() -> None:
    """Load the solver now, so that the first assignment need not wait for it."""
    least_cost_pairs(np.zeros((1, 1)))
