"""Fisher information: closed forms, the defining trace formula, singular cases."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import steering_pair, steering_vectors
from sonar_tracking.passive.performance.fisher_information import (
    source_covariance,
    stochastic_fisher_information,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER

ANGLES = np.deg2rad([-12.0, 3.0, 20.0])
SOURCES = np.array([[1.0, 0.2 + 0.1j, 0.0], [0.2 - 0.1j, 0.5, 0.05j], [0.0, -0.05j, 2.0]])


@pytest.mark.parametrize("level", [0.1, 1.0, 30.0])
@pytest.mark.parametrize("angle", [0.0, 0.9])
def test_one_source_has_its_closed_form(level: float, angle: float) -> None:
    # var = 6 (1 + 1/(M s)) / (N s kappa^2 cos^2(theta) M (M^2 - 1))
    M, N, kappa = 15, 200, np.pi
    expected = 6 * (1 + 1 / (M * level)) / (N * level * kappa**2 * np.cos(angle) ** 2)
    expected /= M * (M**2 - 1)
    information = stochastic_fisher_information(
        POSITIONS, np.array([angle]), WAVENUMBER, np.array([[2.0 * level + 0j]]), 2.0, N
    )
    assert 1.0 / information[0, 0] == pytest.approx(expected, rel=1e-9)


def information_by_the_trace(
    sources: ComplexArray, noise_covariance: ComplexArray, snapshots: float
) -> FloatArray:
    """Return the angles' information after removing all nuisance parameters, from N tr(...)."""
    A, D = steering_pair(POSITIONS, ANGLES, WAVENUMBER)
    inverse = np.linalg.inv(A @ sources @ A.conj().T + 0.7 * noise_covariance)
    derivatives = []
    for n in range(3):
        cross = np.outer(D[:, n], sources[n] @ A.conj().T)
        derivatives.append(cross + cross.conj().T)
    for i in range(3):
        for j in range(i, 3):
            unit = np.zeros((3, 3), dtype=complex)
            unit[i, j] = unit[j, i] = 1.0
            derivatives.append(A @ unit @ A.conj().T)
            if i < j:
                unit[i, j], unit[j, i] = 1j, -1j
                derivatives.append(A @ unit @ A.conj().T)
    derivatives.append(noise_covariance)
    whitened = [inverse @ derivative for derivative in derivatives]
    full = np.array([[np.trace(a @ b).real for b in whitened] for a in whitened])
    nuisance = np.linalg.solve(full[3:, 3:], full[3:, :3])
    return snapshots * (full[:3, :3] - full[:3, 3:] @ nuisance)


@pytest.mark.parametrize("coloured", [False, True])
def test_formula_is_the_trace_formula_without_nuisance_parameters(coloured: bool) -> None:
    index = np.arange(15)
    shape = 0.6 ** np.abs(index[:, None] - index) if coloured else np.eye(15)
    noise_covariance = shape.astype(complex)
    information = stochastic_fisher_information(
        POSITIONS, ANGLES, WAVENUMBER, SOURCES, 0.7, 50, noise_covariance if coloured else None
    )
    expected = information_by_the_trace(SOURCES, noise_covariance, 50)
    assert np.allclose(information, expected, rtol=1e-7)


def test_coincident_sources_give_a_singular_but_finite_information() -> None:
    angles = np.deg2rad([10.0, 10.0, 40.0])
    sources = np.eye(3, dtype=complex)
    information = stochastic_fisher_information(POSITIONS, angles, WAVENUMBER, sources, 1.0, 100)
    assert np.isfinite(information).all()
    assert np.linalg.eigvalsh(information)[0] > -1e-6 * information[2, 2]


def test_information_vanishes_towards_endfire() -> None:
    levels = [
        stochastic_fisher_information(
            POSITIONS, np.deg2rad([angle]), WAVENUMBER, np.eye(1, dtype=complex), 1.0, 100
        )[0, 0]
        for angle in (0.0, 60.0, 89.0, 90.0)
    ]
    assert levels[1] == pytest.approx(levels[0] * 0.25, rel=1e-9)
    assert levels[2] < 1e-3 * levels[0]
    assert levels[3] == pytest.approx(0.0, abs=1e-20 * levels[0])


def test_source_covariance_is_recovered() -> None:
    A = steering_vectors(POSITIONS, ANGLES, WAVENUMBER)
    covariance = A @ SOURCES @ A.conj().T + 0.7 * np.eye(15)
    found = source_covariance(covariance, POSITIONS, ANGLES, WAVENUMBER, np.array(0.7))
    assert np.allclose(found, SOURCES, atol=1e-10)


def test_source_covariance_is_never_negative() -> None:
    # Noise alone, with its power overestimated.
    found = source_covariance(
        np.eye(15, dtype=complex), POSITIONS, ANGLES, WAVENUMBER, np.array(1.2)
    )
    assert np.linalg.eigvalsh(found)[0] >= 0.0


def test_batch_is_many_single_calls() -> None:
    generator = np.random.default_rng(1)
    angles = generator.uniform(-1.0, 1.0, (6, 3))
    root = generator.standard_normal((6, 3, 3)) + 1j * generator.standard_normal((6, 3, 3))
    sources = root @ np.swapaxes(root, -1, -2).conj()
    power = generator.uniform(0.5, 2.0, 6)
    together = stochastic_fisher_information(POSITIONS, angles, WAVENUMBER, sources, power, 20)
    for run in range(6):
        alone = stochastic_fisher_information(
            POSITIONS, angles[run], WAVENUMBER, sources[run], power[run], 20
        )
        assert np.allclose(together[run], alone, rtol=1e-9)


def test_sources_of_one_power_are_shared_by_a_batch() -> None:
    """Numpy 1 and 2 read a matrix beside a stack of matrices differently."""
    angles = np.array([[-0.4, 0.1, 0.7], [-0.2, 0.0, 0.5]])
    arguments = (POSITIONS, angles, WAVENUMBER)
    shared = stochastic_fisher_information(*arguments, np.eye(3, dtype=complex), np.array(1.0), 20)
    each = np.broadcast_to(np.eye(3, dtype=complex), (2, 3, 3))
    alone = stochastic_fisher_information(*arguments, each, np.array(1.0), 20)
    assert np.array_equal(shared, alone)
