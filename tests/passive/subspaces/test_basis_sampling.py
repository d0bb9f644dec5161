"""Protects when a subspace method takes its steps, and that noise is whitened before them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from sonar_tracking.passive.subspaces.basis_sampling import (
    BasisSampler,
    noise_factors,
    start_sampler,
)
from sonar_tracking.passive.subspaces.sample_schedule import first_timing
from tests.passive.block_scene import noise_from_ahead

TIMING = first_timing(0, 100, 0.005)


@dataclass(frozen=True)
class Recorder:
    """A method that remembers the portions it was given, as the numbers of their snapshots."""

    update_snapshots: int = 1

    def start(self, n_elements: int, n_columns: int, batch: tuple[int, ...] = ()) -> Any:
        return ()

    def update(self, state: Any, data: np.ndarray) -> Any:
        return (*state, data[..., 0].real.round(9).tolist())

    def basis(self, state: Any) -> np.ndarray:
        return np.full((2, 1), len(state), dtype=complex)


def numbered(first: int, last: int) -> np.ndarray:
    """Return snapshots of two elements, each with its own number as amplitude."""
    return np.arange(first, last + 1.0)[:, None] * np.ones(2, dtype=complex)


def sampler(step: int, noise: np.ndarray | None = None) -> BasisSampler:
    return start_sampler(Recorder(step), 2, 1, (), noise)


def test_a_method_of_single_snapshots_steps_to_where_a_basis_is_wanted() -> None:
    after, captured = sampler(1).advance(numbered(10, 19), 10, TIMING, [25, 12, 9, 19])
    assert after.state == ([10.0, 11.0, 12.0], [13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0])
    assert [(one.index, one.basis[0, 0]) for one in captured] == [(12, 1.0), (19, 2.0)]
    assert captured[0].timing is TIMING and after.pending.shape == (0, 2)


def test_a_block_method_steps_at_the_multiples_of_its_step() -> None:
    first, captured = sampler(4).advance(numbered(10, 19), 10, TIMING, [16, 18])
    assert first.state == ([10.0, 11.0, 12.0], [13.0, 14.0, 15.0, 16.0])
    assert [one.index for one in captured] == [16]
    assert first.pending[:, 0].real.tolist() == [17.0, 18.0, 19.0]
    second, captured = first.advance(numbered(20, 21), 20, TIMING, [20])
    assert second.state[2:] == ([17.0, 18.0, 19.0, 20.0],)
    assert [(one.index, one.basis[0, 0]) for one in captured] == [(20, 3.0)]
    third, captured = second.advance(numbered(22, 23), 22, TIMING, [])
    assert (third.state, captured) == (second.state, ())
    assert third.pending[:, 0].real.tolist() == [21.0, 22.0, 23.0]
    fourth, _ = third.advance(numbered(24, 24), 24, TIMING, [])
    assert fourth.state[3:] == ([21.0, 22.0, 23.0, 24.0],)


def test_silence_holds_the_recursion() -> None:
    before, _ = sampler(1).advance(numbered(1, 3), 1, TIMING, [])
    after, captured = before.advance(np.zeros((5, 2), complex), 4, TIMING, [8, 5, 9])
    assert after is before
    assert [(one.index, one.basis[0, 0]) for one in captured] == [(5, 1.0), (8, 1.0)]


def test_data_are_whitened_and_bases_coloured() -> None:
    """Twice the amplitude of noise in the first element: half of its data, twice its basis."""
    after, captured = sampler(1, np.diag([4.0, 1.0 + 0.0j])).advance(
        numbered(10, 12), 10, TIMING, [12]
    )
    assert after.state == ([5.0, 5.5, 6.0],)
    assert captured[0].basis[:, 0].real.tolist() == [2.0, 1.0]


def test_factors_of_noise_from_ahead() -> None:
    noise = noise_from_ahead(4)
    colouring, whitening = noise_factors(noise)
    assert np.allclose(colouring @ colouring.conj().T, noise)
    assert np.allclose(whitening @ noise @ whitening.conj().T, np.eye(4))
    # A snapshot x is a row: the whitened row is that of W x.
    snapshot = np.array([[1.0, 2.0j, -1.0, 0.5]])
    recorded, _ = start_sampler(Recorder(), 4, 1, (), noise).advance(snapshot, 0, TIMING, [])
    assert recorded.state[0] == pytest.approx([(whitening @ snapshot[0])[0].real])
