"""Leading eigenvectors of a Hermitian matrix, without computing the others where that is dearer."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from sonar_tracking.records.arrays import ComplexArray

_SMALL = 48
"""Up to this size all eigenvectors cost no more than a few of them."""


def leading_eigenvectors(matrix: ComplexArray, count: int) -> ComplexArray:
    """Return the eigenvectors of the largest eigenvalues.

    Parameters
    ----------
    matrix : ndarray, shape (n, n), complex
        Hermitian, in any unit: linear power, pure numbers.
    count : int
        How many, from 1 to n.

    Returns
    -------
    ndarray, shape (n, count), complex
        Orthonormal columns in the order of ascending eigenvalues.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is not finite.
    """
    size = len(matrix)
    if size <= _SMALL:
        return np.asarray(np.linalg.eigh(matrix).eigenvectors[:, size - count :])
    if not np.isfinite(matrix).all():
        raise np.linalg.LinAlgError("The matrix holds values that are no finite numbers.")
    _, vectors = scipy.linalg.eigh(
        matrix, subset_by_index=(size - count, size - 1), driver="evr", check_finite=False
    )
    return np.asarray(vectors, dtype=np.complex128)
