"""Eigenvalues and eigenvectors of Hermitian matrices, for all who ask for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import ComplexArray, FloatArray


@dataclass(frozen=True)
class Eigenpairs:
    """Eigenvalues and eigenvectors of one Hermitian matrix or of several.

    Attributes
    ----------
    values : ndarray, shape (..., n)
        In the unit of the matrix, descending.
    vectors : ndarray, shape (..., n, n), complex
        Orthonormal columns in their order, pure numbers.
    """

    values: FloatArray
    vectors: ComplexArray

    def of(self, row: int) -> Eigenpairs:
        """Return those of one of several matrices, by its number."""
        return Eigenpairs(self.values[row], self.vectors[row])


def eigenpairs(matrix: ComplexArray) -> Eigenpairs:
    """Return all eigenvalues and eigenvectors.

    Parameters
    ----------
    matrix : ndarray, shape (..., n, n), complex
        Hermitian, in any unit: linear power, pure numbers.
    """
    values, vectors = np.linalg.eigh(matrix)
    return Eigenpairs(values[..., ::-1], vectors[..., ::-1])


def stacked_eigenpairs(each: Sequence[Eigenpairs | None]) -> Eigenpairs | None:
    """Return those of several matrices in a new first dimension, None if one is not known.

    Parameters
    ----------
    each : sequence of Eigenpairs or None
        Of each matrix.
    """
    known = [one for one in each if one is not None]
    if not known or len(known) < len(each):
        return None
    return Eigenpairs(
        np.stack([one.values for one in known]), np.stack([one.vectors for one in known])
    )
