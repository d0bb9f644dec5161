"""PAST: projection approximation subspace tracking, one snapshot at a time.

The recursion itself is in :mod:`sonar_tracking.passive.subspaces.past_recursion`; it starts from
W = I(:, 1:N) and P = I.

References
----------
B. Yang, "Projection approximation subspace tracking", IEEE Trans. Signal Processing 43(1), 1995;
Ryu, Park, Choi (2003), section II.
"""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.passive.subspaces.past_recursion import lead_through
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
        basis, inverse = lead_through(
            data, state.basis, state.inverse_correlation, self.forgetting_factor, False
        )
        return PastState(basis=basis, inverse_correlation=inverse)

    def basis(self, state: PastState) -> ComplexArray:
        """Return W, shape (..., n_elements, n_columns), pure numbers."""
        return state.basis
