"""OPAST: PAST whose basis is kept orthonormal, at linear cost.

For each snapshot x: y = W^H x; q = P y / beta; gamma = 1 / (1 + y^H q); p = gamma (x - W y);
P <- P / beta - gamma q q^H; tau = (1/|q|^2) (1/sqrt(1 + |p|^2 |q|^2) - 1);
p' = tau W q + (1 + tau |q|^2) p; W <- W + p' q^H. P is made Hermitian at each snapshot.

References
----------
K. Abed-Meraim, A. Chkeif, Y. Hua, "Fast orthonormal PAST algorithm", IEEE Signal Processing
Letters 7(3), 2000.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.passive.past import PastState
from sonar_tracking.passive.subspace_method import identity_basis

ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class OrthonormalPast:
    """OPAST with an exponential window.

    Attributes
    ----------
    forgetting_factor : float
        beta, per snapshot.
    """

    forgetting_factor: float

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
        """Return the state after all snapshots of ``data``, shape (..., n_snapshots, M)."""
        beta = self.forgetting_factor
        basis = state.basis.copy()
        inverse = state.inverse_correlation
        conjugate_rows = data.conj()[..., None, :]
        columns = data[..., None]
        for n in range(data.shape[-2]):
            y_row = conjugate_rows[..., n, :, :] @ basis
            q_row = (y_row @ inverse) / beta
            power = (q_row * y_row.conj()).sum(axis=-1, keepdims=True).real
            gamma = 1.0 / (1.0 + power)
            q_column = _transposed(q_row).conj()
            p = gamma * (columns[..., n, :, :] - basis @ _transposed(y_row).conj())
            inverse = inverse / beta - (gamma * q_column) * q_row
            inverse = 0.5 * (inverse + _transposed(inverse).conj())
            q_power = _power(q_column)
            tau = _normalising_factor(q_power, _power(p))
            p = tau * (basis @ q_column) + (1.0 + tau * q_power) * p
            basis += p * q_row
        return PastState(basis=basis, inverse_correlation=inverse)

    def basis(self, state: PastState) -> ComplexArray:
        """Return W."""
        return state.basis


def _normalising_factor(
    q_power: NDArray[np.float64], p_power: NDArray[np.float64]
) -> NDArray[np.float64]:
    # (1/sqrt(1 + ab) - 1) / a without the cancellation, and with its limit 0 at a = 0.
    root = np.sqrt(1.0 + p_power * q_power)
    return -p_power / (root * (1.0 + root))


def _power(column: ComplexArray) -> NDArray[np.float64]:
    return (column.real**2 + column.imag**2).sum(axis=-2, keepdims=True)


def _transposed(matrix: ComplexArray) -> ComplexArray:
    return np.swapaxes(matrix, -1, -2)
