"""Drives a subspace method through a stream of snapshots and takes bases where they are wanted.

Block methods step at every multiple of L of the global snapshot index, wherever the blocks of the
stream begin and end; what is left of a block waits for the next one. Coloured noise is whitened
before the method and the bases are coloured after it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.passive.subspaces.sample_schedule import BlockTiming
from sonar_tracking.passive.subspaces.subspace_method import SubspaceMethod
from sonar_tracking.records.arrays import ComplexArray


@dataclass(frozen=True)
class CapturedSubspace:
    """A basis taken after one snapshot.

    Attributes
    ----------
    index : int
        Global index of the snapshot.
    timing : BlockTiming
        Timing of the block the snapshot came in.
    basis : ndarray, shape (..., n_elements, n_columns), complex
        Basis of the signal subspace, pure numbers.
    """

    index: int
    timing: BlockTiming
    basis: ComplexArray


@dataclass(frozen=True)
class BasisSampler:
    """A subspace method in the middle of a stream.

    Attributes
    ----------
    method : SubspaceMethod
        The method.
    state : object
        Its state.
    pending : ndarray, shape (..., n_pending, n_elements), complex
        Snapshots that wait for a block step to be complete, linear amplitude.
    colouring, whitening : ndarray, shape (n_elements, n_elements), or None
        Cholesky factor of the noise covariance and its inverse, pure numbers; None = white
        noise.
    """

    method: SubspaceMethod[Any]
    state: Any
    pending: ComplexArray
    colouring: ComplexArray | None = None
    whitening: ComplexArray | None = None

    def advance(
        self, data: ComplexArray, first_index: int, timing: BlockTiming, wanted: Iterable[int]
    ) -> tuple[BasisSampler, tuple[CapturedSubspace, ...]]:
        """Return the recursion after more snapshots and the bases wanted on the way.

        Parameters
        ----------
        data : ndarray, shape (..., n_snapshots, n_elements), complex
            The next snapshots, linear amplitude. When all are exactly zero the
            recursion is held: they say nothing, and forgetting the past would make it
            singular.
        first_index : int
            Global index of the first of them.
        timing : BlockTiming
            Of the block they came in.
        wanted : iterable of int
            Global indices of the snapshots after which a basis is taken.
        """
        last_index = first_index + data.shape[-2] - 1
        wanted_here = sorted(index for index in wanted if first_index <= index <= last_index)
        if not data.any():
            held = [
                CapturedSubspace(index, timing, self._basis(self.state)) for index in wanted_here
            ]
            return self, tuple(held)
        white = data if self.whitening is None else data @ self.whitening.T
        state, pending = self.state, self.pending
        captured = []
        start = first_index
        for end in self._step_ends(first_index, last_index, wanted_here):
            portion = white[..., start - first_index : end + 1 - first_index, :]
            if pending.shape[-2]:
                portion = np.concatenate([pending, portion], axis=-2)
                pending = pending[..., :0, :]
            state = self.method.update(state, portion)
            start = end + 1
            if end in wanted_here:
                captured.append(CapturedSubspace(end, timing, self._basis(state)))
        rest = white[..., start - first_index :, :]
        if rest.shape[-2]:
            pending = np.concatenate([pending, rest], axis=-2)
        return replace(self, state=state, pending=pending), tuple(captured)

    def _step_ends(self, first: int, last: int, wanted: list[int]) -> Iterable[int]:
        step = self.method.update_snapshots
        if step == 1:
            return sorted({*wanted, last})
        return range(-(-first // step) * step, last + 1, step)

    def _basis(self, state: Any) -> ComplexArray:
        basis = self.method.basis(state)
        return basis if self.colouring is None else self.colouring @ basis


def start_sampler(
    method: SubspaceMethod[Any],
    n_elements: int,
    n_columns: int,
    batch: tuple[int, ...],
    noise_covariance: ComplexArray | None,
) -> BasisSampler:
    """Return a sampler before its first snapshot.

    Parameters
    ----------
    method : SubspaceMethod
        The method.
    n_elements, n_columns : int
        Of the basis.
    batch : tuple of int
        Leading dimensions; empty = a single run.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, or None
        Pure numbers with trace n_elements; None = white.
    """
    colouring = whitening = None
    if noise_covariance is not None:
        colouring, whitening = noise_factors(noise_covariance)
    return BasisSampler(
        method=method,
        state=method.start(n_elements, n_columns, batch),
        pending=np.empty((*batch, 0, n_elements), dtype=np.complex128),
        colouring=colouring,
        whitening=whitening,
    )


def noise_factors(noise_covariance: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the Cholesky factor of a noise covariance and its inverse.

    Parameters
    ----------
    noise_covariance : ndarray, shape (n_elements, n_elements), complex
        Pure numbers with trace n_elements.

    Returns
    -------
    colouring, whitening : ndarray, shape (n_elements, n_elements), complex
        Pure numbers.
    """
    colouring = np.asarray(np.linalg.cholesky(noise_covariance), dtype=np.complex128)
    return colouring, np.asarray(np.linalg.inv(colouring), dtype=np.complex128)
