"""Stands in for a signal subspace that nobody looks at.

A tracker that measures in the block covariance takes no bearing from the subspaces. Where both run
in one process and nothing else sees the estimates, the subspace need not be followed.
"""

from __future__ import annotations

from sonar_tracking.passive.subspaces.subspace_method import identity_basis
from sonar_tracking.records.arrays import ComplexArray


class UnfollowedSubspace:
    """A subspace that stays where it starts; its state is its basis."""

    @property
    def update_snapshots(self) -> int:
        """1: the snapshots may be given in portions of any size."""
        return 1

    def start(self, n_elements: int, n_columns: int, batch: tuple[int, ...] = ()) -> ComplexArray:
        """Return the basis it keeps, (*batch, n_elements, n_columns), pure numbers."""
        return identity_basis(n_elements, n_columns, batch)

    def update(self, state: ComplexArray, data: ComplexArray) -> ComplexArray:
        """Return the basis as it is, shape (..., n_elements, n_columns), pure numbers.

        Parameters
        ----------
        state : ndarray, shape (..., n_elements, n_columns), complex
            The basis, pure numbers.
        data : ndarray, shape (..., n_snapshots, n_elements), complex
            Linear amplitude; not used.
        """
        return state

    def basis(self, state: ComplexArray) -> ComplexArray:
        """Return the basis, shape (..., n_elements, n_columns), pure numbers."""
        return state
