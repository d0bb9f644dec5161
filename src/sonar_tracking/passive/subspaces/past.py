"""PAST: projection approximation subspace tracking, one snapshot at a time.

For each snapshot x: y = W^H x; h = P y; g = h / (beta + Re y^H h); P <- (P - g h^H) / beta;
P <- (P + P^H) / 2; W <- W + (x - W y) g^H, from W = I(:, 1:N) and P = I. Without the third step
P loses its symmetry after a few hundred snapshots and the recursion diverges.

The vectors are kept as rows (y^H, h^H, g^H), so that a batch of runs and a single run go through
the same few matrix products.

References
----------
B. Yang, "Projection approximation subspace tracking", IEEE Trans. Signal Processing 43(1), 1995;
Ryu, Park, Choi (2003), section II.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_method import identity_basis
from sonar_tracking.records.arrays import ComplexArray


@dataclass(frozen=True)
class PastState:
    """State of PAST.

    Attributes
    ----------
    basis : ndarray, shape (..., n_elements, n_columns), complex
        W, pure numbers; its columns become nearly orthonormal but are not made so.
    inverse_correlation : ndarray, shape (..., n_columns, n_columns), complex
        P, Hermitian, 1 over linear power.
    """

    basis: ComplexArray
    inverse_correlation: ComplexArray


@dataclass(frozen=True)
class Past:
    """PAST with an exponential window.

    Attributes
    ----------
    forgetting_factor : float
        beta, per snapshot.
    """

    forgetting_factor: float

    @classmethod
    def configured(cls, configuration: SubspaceConfiguration) -> Past:
        """Return the method with the parameters of the stage."""
        return cls(configuration.forgetting_factor)

    @property
    def update_snapshots(self) -> int:
        """1: the snapshots may be given in portions of any size."""
        return 1

    def start(self, n_elements: int, n_columns: int, batch: tuple[int, ...] = ()) -> PastState:
        """Return W = I(:, 1:N) and P = I."""
        return PastState(
            basis=identity_basis(n_elements, n_columns, batch),
            inverse_correlation=identity_basis(n_columns, n_columns, batch),
        )

    def update(self, state: PastState, data: ComplexArray) -> PastState:
        """Return the state after all snapshots.

        Parameters
        ----------
        state : PastState
            Before them.
        data : ndarray, shape (..., n_snapshots, n_elements), complex
            Linear amplitude.
        """
        beta = self.forgetting_factor
        basis = state.basis.copy()
        inverse = state.inverse_correlation
        conjugate_rows = data.conj()[..., None, :]
        columns = data[..., None]
        for n in range(data.shape[-2]):
            y_row = conjugate_rows[..., n, :, :] @ basis
            h_row = y_row @ inverse
            power = (h_row * y_row.conj()).sum(axis=-1, keepdims=True).real
            g_row = h_row / (beta + power)
            inverse = (inverse - _transposed(g_row).conj() * h_row) / beta
            inverse = 0.5 * (inverse + _transposed(inverse).conj())
            residual = columns[..., n, :, :] - basis @ _transposed(y_row).conj()
            basis += residual * g_row
        return PastState(basis=basis, inverse_correlation=inverse)

    def basis(self, state: PastState) -> ComplexArray:
        """Return W, shape (..., n_elements, n_columns), pure numbers."""
        return state.basis


def _transposed(matrix: ComplexArray) -> ComplexArray:
    return np.swapaxes(matrix, -1, -2)
