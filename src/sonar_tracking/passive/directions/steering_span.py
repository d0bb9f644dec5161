"""The span of steering vectors: coefficients in it and what lies outside it.

From singular vectors and not from products of the steering vectors, so that both stay accurate
where two bearings nearly coincide; directions that coincide are one direction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import ComplexArray

_LEAST_SEPARABLE = 1e-8
"""Singular values of the steering matrix below this share of the largest are not inverted."""


@dataclass(frozen=True)
class SteeringSpan:
    """Span of the columns of a steering matrix S.

    Attributes
    ----------
    orthonormal : ndarray, shape (..., n_elements, n_targets), complex
        Orthonormal columns that span it, pure numbers; zero columns where S has a lower
        rank.
    inverse : ndarray, shape (..., n_targets, n_elements), complex
        S^+, pure numbers.
    """

    orthonormal: ComplexArray
    inverse: ComplexArray

    def outside(self, columns: ComplexArray) -> ComplexArray:
        """Return what of some columns lies outside the span, P_S times them.

        Parameters
        ----------
        columns : ndarray, shape (..., n_elements, n), complex
            In any unit.

        Returns
        -------
        ndarray, shape (..., n_elements, n), complex
            In units of the columns.
        """
        within = np.swapaxes(self.orthonormal, -1, -2).conj() @ columns
        return columns - self.orthonormal @ within


def steering_span(vectors: ComplexArray) -> SteeringSpan:
    """Return the span of steering vectors.

    Parameters
    ----------
    vectors : ndarray, shape (..., n_elements, n_targets), complex
        S, pure numbers; at least as many elements as targets.
    """
    left, values, right = np.linalg.svd(vectors, full_matrices=False)
    kept = values > _LEAST_SEPARABLE * values[..., :1]
    reciprocal = np.where(kept, 1.0, 0.0) / np.where(kept, values, 1.0)
    scaled = np.swapaxes(right, -1, -2).conj() * reciprocal[..., None, :]
    return SteeringSpan(
        orthonormal=left * kept[..., None, :],
        inverse=scaled @ np.swapaxes(left, -1, -2).conj(),
    )
