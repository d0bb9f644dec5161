"""Subspace trackers: PAST as published, its variants, and the subspace they converge to."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.subspaces.block_past import BlockPast
from sonar_tracking.passive.subspaces.exponential_covariance import ExponentialCovariance
from sonar_tracking.passive.subspaces.orthonormal_past import OrthonormalPast
from sonar_tracking.passive.subspaces.past import Past
from sonar_tracking.passive.subspaces.subspace_method import SubspaceMethod
from tests.passive.crossing_scene import (
    POSITIONS,
    WAVENUMBER,
    ComplexArray,
    crossing_data,
    snapshots_of,
)

METHODS: list[SubspaceMethod[Any]] = [
    Past(0.97),
    OrthonormalPast(0.97),
    BlockPast(0.97, 20),
    ExponentialCovariance(0.97),
]


def past_by_the_letter(data: ComplexArray, n_columns: int, beta: float) -> ComplexArray:
    """Return W after all snapshots, by the equations of Yang (1995) one by one."""
    W = np.eye(data.shape[1], n_columns, dtype=complex)
    P = np.eye(n_columns, dtype=complex)
    for x in data:
        y = W.conj().T @ x
        h = P @ y
        g = h / (beta + np.real(np.vdot(y, h)))
        P = (P - np.outer(g, h.conj())) / beta
        P = (P + P.conj().T) / 2
        W = W + np.outer(x - W @ y, g.conj())
    return W


def largest_angle(first: ComplexArray, second: ComplexArray) -> float:
    """Return the sine of the largest angle between two subspaces."""
    a, b = np.linalg.qr(first).Q, np.linalg.qr(second).Q
    return float(np.linalg.norm(b - a @ (a.conj().T @ b), 2))


def run(method: SubspaceMethod[Any], data: ComplexArray, n_columns: int) -> ComplexArray:
    """Return the basis after all snapshots, given in the portions the method asks for."""
    state = method.start(data.shape[-1], n_columns, data.shape[:-2])
    portion = max(method.update_snapshots, 1)
    for first in range(0, data.shape[-2], portion):
        state = method.update(state, data[..., first : first + portion, :])
    return method.basis(state)


@pytest.mark.parametrize("beta", [0.86, 0.97, 0.99])
def test_past_is_the_published_recursion(beta: float) -> None:
    data = crossing_data(1, 0.0, 4.0)
    method = Past(beta)
    basis = method.basis(method.update(method.start(15, 5), data))
    assert np.abs(basis - past_by_the_letter(data, 5, beta)).max() < 1e-11


def test_inverse_correlation_stays_hermitian() -> None:
    # Without re-symmetrising it is lost after some 150 updates and everything turns NaN.
    data = crossing_data(2, 0.0, 39.0)
    method = Past(0.86)
    state = method.update(method.start(15, 5), data)
    P = state.inverse_correlation
    assert np.array_equal(P, P.conj().T)
    assert np.linalg.eigvalsh(P)[0] > 0.0
    assert np.isfinite(state.basis).all()


@pytest.mark.parametrize("method", METHODS, ids=lambda method: type(method).__name__)
def test_every_method_finds_the_signal_subspace(method: SubspaceMethod[Any]) -> None:
    # Strong static sources: the span of their steering vectors, within the sampling noise.
    angles = np.broadcast_to(np.deg2rad([-40.0, 0.0, 25.0]), (1500, 3))
    data = snapshots_of(np.random.default_rng(3), angles, 20.0)
    truth = steering_vectors(POSITIONS, angles[0], WAVENUMBER)
    assert largest_angle(truth, run(method, data, 3)) < 0.05


@pytest.mark.parametrize("method", METHODS[:3], ids=lambda method: type(method).__name__)
def test_recursions_agree_with_the_eigenvectors(method: SubspaceMethod[Any]) -> None:
    angles = np.broadcast_to(np.deg2rad([-40.0, 0.0, 25.0]), (1500, 3))
    data = snapshots_of(np.random.default_rng(4), angles, 10.0)
    exact = run(ExponentialCovariance(0.97), data, 3)
    assert largest_angle(exact, run(method, data, 3)) < 0.08


@pytest.mark.parametrize("method", METHODS, ids=lambda method: type(method).__name__)
def test_batch_is_many_single_runs(method: SubspaceMethod[Any]) -> None:
    data = crossing_data(5, 0.0, 1.0, batch=(3,))
    together = run(method, data, 5)
    for number in range(3):
        alone = run(method, data[number], 5)
        assert np.abs(together[number] - alone).max() < 1e-11


@pytest.mark.parametrize("method", METHODS, ids=lambda method: type(method).__name__)
def test_a_common_phase_and_scale_change_nothing(method: SubspaceMethod[Any]) -> None:
    # Up to what is left of the start, whose unit matrix has a scale.
    data = crossing_data(6, 0.0, 4.0)
    other = run(method, 7.0 * np.exp(0.4j) * data, 5)
    assert largest_angle(run(method, data, 5), other) < 1e-9


def test_orthonormal_past_is_orthonormal() -> None:
    basis = run(OrthonormalPast(0.86), crossing_data(7, 0.0, 10.0), 5)
    assert np.abs(basis.conj().T @ basis - np.eye(5)).max() < 1e-10


def test_block_past_of_single_snapshots_is_past() -> None:
    data = crossing_data(8, 0.0, 3.0)
    assert np.abs(run(BlockPast(0.9, 1), data, 5) - run(Past(0.9), data, 5)).max() < 1e-10


def test_block_past_is_the_rank_l_step() -> None:
    # The same step written with P = R^-1 and an L x L inverse.
    data = crossing_data(9, 0.0, 0.0)[:48]
    beta, L = 0.9, 16
    W, P = np.eye(15, 5, dtype=complex), np.eye(5, dtype=complex)
    weights = np.sqrt(beta ** np.arange(L - 1, -1, -1))
    for first in range(0, 48, L):
        X = data[first : first + L].T * weights
        Y = W.conj().T @ X
        G = P @ Y @ np.linalg.inv(beta**L * np.eye(L) + Y.conj().T @ P @ Y)
        W = W + (X - W @ Y) @ G.conj().T
        P = (P - G @ Y.conj().T @ P) / beta**L
    assert np.abs(run(BlockPast(beta, L), data, 5) - W).max() < 1e-10


def test_covariance_does_not_depend_on_the_portions() -> None:
    data = crossing_data(10, 0.0, 1.0)
    method = ExponentialCovariance(0.95)
    at_once = method.update(method.start(15, 5), data).covariance
    state = method.start(15, 5)
    for first in range(0, len(data), 37):
        state = method.update(state, data[first : first + 37])
    assert np.abs(at_once - state.covariance).max() < 1e-12
    weights = 0.05 * 0.95 ** np.arange(len(data) - 1, -1, -1)
    assert np.abs(at_once - (data.T * weights) @ data.conj()).max() < 1e-12
