"""Exponentially weighted covariance and its leading eigenvectors.

C <- beta^L C + (1 - beta) sum_i beta^(L-1-i) x_i x_i^H over portions of L snapshots, whatever L;
the basis is the eigenvectors of the largest eigenvalues. This is the exact solution of the
criterion that PAST approximates; for small arrays it is also the cheaper one, since the
eigenvectors are computed only when a basis is asked for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.leading_eigenvectors import leading_eigenvectors
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.arrays import ComplexArray


@dataclass(frozen=True)
class CovarianceState:
    """State of the covariance recursion.

    Attributes
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        C, linear power; it reaches the level of the data after 1 / (1 - beta) snapshots.
    n_columns : int
        Eigenvectors that make the basis.
    """

    covariance: ComplexArray
    n_columns: int


@dataclass(frozen=True)
class ExponentialCovariance:
    """Eigenvectors of an exponentially weighted covariance.

    Attributes
    ----------
    forgetting_factor : float
        beta, per snapshot.
    """

    forgetting_factor: float

    @classmethod
    def configured(cls, configuration: SubspaceConfiguration) -> ExponentialCovariance:
        """Return the method with the parameters of the stage."""
        return cls(configuration.forgetting_factor)

    @property
    def update_snapshots(self) -> int:
        """1: the snapshots may be given in portions of any size."""
        return 1

    def start(
        self, n_elements: int, n_columns: int, batch: tuple[int, ...] = ()
    ) -> CovarianceState:
        """Return the covariance 0."""
        covariance = np.zeros((*batch, n_elements, n_elements), dtype=np.complex128)
        return CovarianceState(covariance=covariance, n_columns=n_columns)

    def update(self, state: CovarianceState, data: ComplexArray) -> CovarianceState:
        """Return the state after all snapshots.

        Parameters
        ----------
        state : CovarianceState
            Before them.
        data : ndarray, shape (..., n_snapshots, n_elements), complex
            Linear amplitude.
        """
        beta = self.forgetting_factor
        n_snapshots = data.shape[-2]
        weights = (1.0 - beta) * beta ** np.arange(n_snapshots - 1, -1, -1)
        newest = np.swapaxes(data, -1, -2) @ (data.conj() * weights[:, None])
        covariance = beta**n_snapshots * state.covariance + newest
        return CovarianceState(covariance=covariance, n_columns=state.n_columns)

    def basis(self, state: CovarianceState) -> ComplexArray:
        """Return the eigenvectors of the largest eigenvalues, largest first.

        Returns
        -------
        ndarray, shape (..., n_elements, n_columns), complex
            Orthonormal columns, pure numbers.
        """
        return leading_eigenvectors(state.covariance, state.n_columns)[1]
