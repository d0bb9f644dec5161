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

from sonar_tracking.passive.subspaces.past import Past, PastState
from sonar_tracking.records.arrays import ComplexArray, FloatArray


@dataclass(frozen=True)
class OrthonormalPast(Past):
    """OPAST with an exponential window; it starts as PAST does and has the same state."""

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


def _normalising_factor(q_power: FloatArray, p_power: FloatArray) -> FloatArray:
    # (1/sqrt(1 + ab) - 1) / a without the cancellation, and with its limit 0 at a = 0.
    root = np.sqrt(1.0 + p_power * q_power)
    return -p_power / (root * (1.0 + root))


def _power(column: ComplexArray) -> FloatArray:
    return (column.real**2 + column.imag**2).sum(axis=-2, keepdims=True)


def _transposed(matrix: ComplexArray) -> ComplexArray:
    return np.swapaxes(matrix, -1, -2)
