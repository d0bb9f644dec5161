"""Protects: the study's trackers and conventions, against an independent coding.

In the paper's angle, from the array axis in degrees, one target and one step at a time.
"""

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.batch_runner import run_batches
from sonar_tracking.evaluation.studies.doa_coherent.runs import (
    JOINT,
    PROPOSED,
    RYU,
    ConditionBatch,
    condition_batch,
)
from sonar_tracking.evaluation.studies.doa_coherent.scenes import (
    COHERENT,
    COLOURED,
    CROSSING,
    INCOHERENT,
    Condition,
    bursts,
    sources_of,
)

Array = np.ndarray

ELEMENTS, SNAPSHOTS, PERIOD, STEPS = 15, 32, 8.0, 80
DEGREE = np.pi / 180.0


def steering(phi: Array) -> tuple[Array, Array, Array]:
    """Return S, its derivative and the projector on its complement at angles from the axis, rad."""
    p = np.arange(ELEMENTS)[:, None]
    S = np.exp(-1j * np.pi * p * np.cos(phi))
    L = 1j * np.pi * p * np.sin(phi) * S
    return S, L, np.eye(ELEMENTS) - S @ np.linalg.inv(S.conj().T @ S) @ S.conj().T


def ryu_angles(C: Array, phi: Array) -> Array:
    E = np.linalg.eigh(C)[1][:, -len(phi) :]
    S, L, _ = steering(phi)
    complement = np.eye(ELEMENTS) - E @ E.conj().T
    y, u = complement @ S, complement @ L
    return phi - np.sum(u.conj() * y, axis=0).real / np.sum(np.abs(u) ** 2, axis=0)


def fitted_angles(b: Array, phi: Array) -> Array:
    for _ in range(3):
        S, L, P = steering(phi)
        cost = np.sum(np.abs(P @ b) ** 2)
        A, a = np.zeros((len(phi), len(phi))), np.zeros(len(phi))
        for e in b.T:
            C = (P @ L) * np.linalg.lstsq(S, e, rcond=None)[0]
            A, a = A + (C.conj().T @ C).real, a + (C.conj().T @ P @ e).real
        step = np.linalg.solve(A, a)
        step *= min(1.0, 0.5 * DEGREE / np.abs(step).max())
        for halving in range(9):
            trial = phi + 0.5**halving * step
            if np.sum(np.abs(steering(trial)[2] @ b) ** 2) < cost:
                phi = trial
                break
    return phi


def generalised(C: Array, Cv: Array, rank: int) -> tuple[Array, Array, Array]:
    """Return eigenvalues, all descending, whitened eigenvectors of the signal, and the factor."""
    factor = np.linalg.cholesky(Cv)
    inverse = np.linalg.inv(factor)
    values, vectors = np.linalg.eigh(inverse @ C @ inverse.conj().T)
    return values[::-1], vectors[:, ::-1][:, :rank], factor


def start(phi: Array, rate: Array) -> tuple[Array, Array, Array, Array]:
    """Return states [angle, rate], their covariances, transition and process noise, deg."""
    F = np.array([[1.0, PERIOD], [0.0, 1.0]])
    Q = 1e-6 * np.array([[PERIOD**3 / 3, PERIOD**2 / 2], [PERIOD**2 / 2, PERIOD]])
    x = np.stack([phi, rate], axis=-1)
    return x, np.stack([np.diag([1.0, 0.01])] * len(phi)), F, Q


def plain_kalman(
    covariances: Array,
    Cv: Array,
    rank: int,
    phi: Array,
    rate: Array,
    ryu: bool,
) -> Array:
    x, P, F, Q = start(phi, rate)
    history = []
    for C in covariances:
        x = x @ F.T
        predicted = x[:, 0] * DEGREE
        if ryu:
            measured = ryu_angles(C, predicted)
        else:
            _, vectors, factor = generalised(C, Cv, rank)
            measured = fitted_angles(factor @ vectors, predicted)
        for n in range(len(x)):
            P[n] = F @ P[n] @ F.T + Q
            gain = P[n][:, 0] / (P[n][0, 0] + 0.05)
            P[n] = P[n] - np.outer(gain, P[n][0])
            x[n] += gain * (measured[n] / DEGREE - x[n, 0])
        history.append(x[:, 0].copy())
    return np.array(history)


def plain_joint(covariances: Array, Cv: Array, rank: int, phi: Array, rate: Array) -> Array:
    n, (x, each, F, Q) = len(phi), start(phi, rate)
    # Everything in rad, target by target: [angle, rate, angle, rate, ...].
    state = x.reshape(-1) * DEGREE
    P = np.kron(np.eye(n), each[0]) * DEGREE**2
    F, Q = np.kron(np.eye(n), F), np.kron(np.eye(n), Q) * DEGREE**2
    H = np.kron(np.eye(n), [[1.0, 0.0]])
    history = []
    for C in covariances:
        state, P = F @ state, F @ P @ F.T + Q
        values, E, factor = generalised(C, Cv, rank)
        noise = np.mean(values[rank:])
        th0 = th = H @ state
        for _ in range(2):
            S, D, _ = steering(th)
            S, D = np.linalg.solve(factor, S), np.linalg.solve(factor, D)
            outside = np.eye(ELEMENTS) - S @ np.linalg.pinv(S)
            J, g = np.zeros((n, n)), np.zeros(n)
            for value, e in zip(values, E.T, strict=False):
                w = 2 * SNAPSHOTS / noise * (value - noise) ** 2 / value
                y = np.linalg.pinv(S) @ e
                J += w * ((D.conj().T @ outside @ D) * np.outer(y.conj(), y)).real
                g += w * (y.conj() * (D.conj().T @ outside @ e)).real
            b = np.linalg.solve(np.eye(n) + J @ H @ P @ H.T, g + J @ (th - th0))
            th = th0 + H @ P @ H.T @ b
        state = state + P @ H.T @ b
        P = P - P @ H.T @ np.linalg.inv(np.eye(n) + J @ H @ P @ H.T) @ J @ H @ P
        history.append(H @ state / DEGREE)
    return np.array(history)


@pytest.mark.parametrize("kind", [INCOHERENT, COHERENT, COLOURED])
def test_all_trackers_equal_an_independent_coding(kind: str) -> None:
    condition = Condition(CROSSING, kind)
    (batch,) = run_batches(2, seed=5)
    result = condition_batch(ConditionBatch(condition, batch))
    data = np.array([block.data[1] for block in bursts(sources_of(condition, batch.seeds))][1:])
    covariances = np.swapaxes(data, 1, 2) @ data.conj() / SNAPSHOTS
    index = np.arange(ELEMENTS)
    Cv = np.power(0.6, np.abs(index[:, None] - index)) if kind == COLOURED else np.eye(ELEMENTS)
    rank = 1 if kind == COHERENT else 3
    closest, ranges = np.array([120.0, 20.0, 320.0]), np.array([1300.0, 1400.0, 2300.0])
    speeds = np.array([3.0, -4.0, 5.0])
    slope = speeds / ranges
    phi = np.array([83.0, 94.0, 69.0]) + np.degrees(np.arctan(-slope * closest))
    rate = np.degrees(slope / (1 + (slope * closest) ** 2))
    expected = {
        RYU: plain_kalman(covariances, Cv, rank, phi, rate, ryu=True),
        PROPOSED: plain_kalman(covariances, Cv, rank, phi, rate, ryu=False),
        JOINT: plain_joint(covariances, Cv, rank, phi, rate),
    }
    for name, angles in expected.items():
        ours = np.degrees(result.histories[name].angle[1]) + 90.0
        # A lost track may turn past the axis, where ours is folded back.
        inside = np.abs(angles - 90.0) < 90.0
        assert np.abs(ours - angles)[inside].max() < 1e-8, name
