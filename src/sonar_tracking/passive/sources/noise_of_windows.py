"""The noise covariances of windows that are dealt with together: one for all, or each its own.

What is known of the noise before the data come is common to all windows, what is found in the data
differs from run to run.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.records.arrays import ComplexArray, IndexArray


def common_or_stacked(each: Sequence[ComplexArray | None]) -> ComplexArray | None:
    """Return the matrix that all windows have in common, or those of each in a new first dimension.

    Parameters
    ----------
    each : sequence of (ndarray, shape (n_elements, n_elements), complex, or None)
        Of each window; None = white noise, in all of them or in none. Pure numbers.

    Returns
    -------
    ndarray, shape (n_elements, n_elements) or (n_windows, n_elements, n_elements), complex, or None
        Pure numbers.
    """
    first = each[0]
    known = [one for one in each if one is not None]
    if first is None or all(one is first or np.array_equal(one, first) for one in known):
        return first
    return np.stack(known)


def of_windows(matrices: ComplexArray | None, rows: IndexArray) -> ComplexArray | None:
    """Return what :func:`common_or_stacked` gave, of some of the windows.

    Parameters
    ----------
    matrices : ndarray, shape (..., n_elements, n_elements), complex, or None
        Of all windows, pure numbers.
    rows : ndarray of int, shape (n_kept,)
        Which of them.

    Returns
    -------
    ndarray, shape (..., n_elements, n_elements), complex, or None
        Of those windows, pure numbers.
    """
    return matrices if matrices is None or matrices.ndim == 2 else matrices[rows]
