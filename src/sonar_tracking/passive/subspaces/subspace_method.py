"""The interface every subspace method has: frozen state in, snapshots in, frozen state out.

Leading dimensions ``...`` are a batch of independent runs. A method never looks at stamps; the
stage around it decides which snapshots it gets and when a basis is taken.
"""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar

import numpy as np

from sonar_tracking.records.arrays import ComplexArray

State = TypeVar("State")


class SubspaceMethod(Protocol, Generic[State]):
    """Recursive estimator of the signal subspace of an array."""

    @property
    def update_snapshots(self) -> int:
        """Snapshots to give to each update; 1 = any number, the result does not depend on it."""
        ...

    def start(self, n_elements: int, n_columns: int, batch: tuple[int, ...] = ()) -> State:
        """Return the state before any snapshot."""
        ...

    def update(self, state: State, data: ComplexArray) -> State:
        """Return the state after more snapshots.

        Parameters
        ----------
        state : object
            Before them.
        data : ndarray, shape (..., n_snapshots, n_elements), complex
            Linear amplitude.
        """
        ...

    def basis(self, state: State) -> ComplexArray:
        """Return a basis of the subspace, shape (..., n_elements, n_columns), pure numbers."""
        ...


def identity_basis(n_elements: int, n_columns: int, batch: tuple[int, ...]) -> ComplexArray:
    """Return I(:, :n_columns) of every run, pure numbers, (*batch, n_elements, n_columns)."""
    basis = np.zeros((*batch, n_elements, n_columns), dtype=np.complex128)
    basis[..., : min(n_elements, n_columns), :] = np.eye(min(n_elements, n_columns), n_columns)
    return basis
