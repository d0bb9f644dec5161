"""Block PAST: one recursive-least-squares step of rank L for L snapshots.

With the weighted snapshots X = [sqrt(beta^(L-1-i)) x_i] and Y = W^H X, the step is
R <- beta^L R + Y Y^H; W <- W + (X - W Y) Y^H R^-1, where R = P^-1 is the correlation of y. This
is PAST with its basis held during the L snapshots; for L = 1 it is PAST itself. Keeping R instead
of P leaves nothing to re-symmetrise and needs one N x N solution a block.

References
----------
B. Yang, "Projection approximation subspace tracking", IEEE Trans. Signal Processing 43(1), 1995,
eqs. 16-20 (the exponentially weighted least-squares criterion solved here).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.passive.subspaces.past import Past
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_method import identity_basis
from sonar_tracking.records.arrays import ComplexArray


@dataclass(frozen=True)
class BlockPastState:
    """State of block PAST.

    Attributes
    ----------
    basis : ndarray, shape (..., n_elements, n_columns), complex
        W, pure numbers.
    correlation : ndarray, shape (..., n_columns, n_columns), complex
        R, the weighted correlation of the projected snapshots, Hermitian, linear power.
    """

    basis: ComplexArray
    correlation: ComplexArray


@dataclass(frozen=True)
class BlockPast:
    """Block PAST with an exponential window.

    Attributes
    ----------
    forgetting_factor : float
        beta, per snapshot.
    update_snapshots : int
        L, snapshots of one step.
    """

    forgetting_factor: float
    update_snapshots: int

    @classmethod
    def configured(cls, configuration: SubspaceConfiguration) -> BlockPast | Past:
        """Return the method with the parameters of the stage; a step of one snapshot is PAST."""
        if configuration.step == 1:
            return Past(configuration.forgetting_factor)
        return cls(configuration.forgetting_factor, configuration.step)

    def start(self, n_elements: int, n_columns: int, batch: tuple[int, ...] = ()) -> BlockPastState:
        """Return W = I(:, 1:N) and R = I."""
        return BlockPastState(
            basis=identity_basis(n_elements, n_columns, batch),
            correlation=identity_basis(n_columns, n_columns, batch),
        )

    def update(self, state: BlockPastState, data: ComplexArray) -> BlockPastState:
        """Return the state after one step on all snapshots.

        Parameters
        ----------
        state : BlockPastState
            Before them.
        data : ndarray, shape (..., n_snapshots, n_elements), complex
            Linear amplitude.
        """
        beta = self.forgetting_factor
        n_snapshots = data.shape[-2]
        weights = beta ** (0.5 * np.arange(n_snapshots - 1, -1, -1))
        rows = data * weights[:, None]
        y_rows = rows.conj() @ state.basis
        y_power = _hermitian(y_rows) @ y_rows
        correlation = beta**n_snapshots * state.correlation + y_power
        cross = np.swapaxes(rows, -1, -2) @ y_rows
        change = cross - state.basis @ y_power
        gain = _hermitian(np.asarray(np.linalg.solve(correlation, _hermitian(change))))
        return BlockPastState(basis=state.basis + gain, correlation=correlation)

    def basis(self, state: BlockPastState) -> ComplexArray:
        """Return W, shape (..., n_elements, n_columns), pure numbers."""
        return state.basis


def _hermitian(matrix: ComplexArray) -> ComplexArray:
    return np.swapaxes(matrix, -1, -2).conj()
