"""Score and information of a block: gradient, Fisher information, crossings, invariances."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.directions.signal_subspace import SignalSubspace, signal_subspace
from sonar_tracking.passive.directions.weighted_subspace_fit import weighted_subspace_fit
from sonar_tracking.passive.performance.fisher_information import stochastic_fisher_information
from tests.passive.block_scene import (
    ANGLES,
    COHERENT,
    INCOHERENT,
    ComplexArray,
    FloatArray,
    exact_covariance,
    noise_colour,
    sampled_covariance,
)
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER

SNAPSHOTS = 64
CASES = [(INCOHERENT, 2, 0.0), (INCOHERENT, 2, 0.6), (COHERENT, 1, 0.0), (COHERENT, 1, 0.6)]


def log_likelihood(subspace: SignalSubspace, angles: FloatArray) -> float:
    """Return -(N / sigma^2) sum_m w_m ||P_S e_m||^2, with a projection matrix."""
    vectors = subspace.whitened(steering_vectors(POSITIONS, angles, WAVENUMBER))
    complement = np.eye(15) - vectors @ np.linalg.pinv(vectors)
    power = float(subspace.noise_power)
    weights = (subspace.eigenvalues - power) ** 2 / subspace.eigenvalues
    distances = np.sum(np.abs(complement @ subspace.vectors) ** 2, axis=0)
    return float(-SNAPSHOTS / power * np.sum(weights * distances))


@pytest.mark.parametrize(("sources", "rank", "correlation"), CASES)
def test_score_is_the_gradient(sources: ComplexArray, rank: int, correlation: float) -> None:
    covariance = sampled_covariance(1, sources, correlation)
    subspace = signal_subspace(covariance, rank, noise_colour(correlation))
    angles = ANGLES + np.deg2rad([0.4, -0.3])
    score = weighted_subspace_fit(subspace, SNAPSHOTS, POSITIONS, angles, WAVENUMBER).score
    step = 1e-6
    for target in range(2):
        offset = step * np.eye(2)[target]
        difference = log_likelihood(subspace, angles + offset) - log_likelihood(
            subspace, angles - offset
        )
        assert score[target] == pytest.approx(difference / (2.0 * step), rel=1e-6)


@pytest.mark.parametrize(("sources", "rank", "correlation"), CASES)
def test_information_is_the_stochastic_fisher_information(
    sources: ComplexArray, rank: int, correlation: float
) -> None:
    colour = noise_colour(correlation)
    subspace = signal_subspace(exact_covariance(sources, correlation), rank, colour)
    fit = weighted_subspace_fit(subspace, SNAPSHOTS, POSITIONS, ANGLES, WAVENUMBER)
    fisher = stochastic_fisher_information(
        POSITIONS, ANGLES, WAVENUMBER, sources, 0.7, SNAPSHOTS, colour
    )
    assert np.allclose(fit.information, fisher, rtol=1e-8, atol=1e-8 * fisher.max())
    assert np.abs(fit.score).max() < 1e-8 * fisher.max()


@pytest.mark.parametrize("separation", [0.0, 1e-12, 1e-9, 1e-7, 1e-4])
def test_information_at_a_crossing_is_finite_and_not_negative(separation: float) -> None:
    subspace = signal_subspace(sampled_covariance(2, INCOHERENT), 2)
    angles = np.array([0.1, 0.1 + separation])
    fit = weighted_subspace_fit(subspace, SNAPSHOTS, POSITIONS, angles, WAVENUMBER)
    assert np.isfinite(fit.score).all()
    assert np.isfinite(fit.information).all()
    values = np.linalg.eigvalsh(fit.information)
    assert values[0] >= -1e-6 * abs(values[1])
    if separation == 0.0:
        assert values[0] == pytest.approx(0.0, abs=1e-6 * values[1])


def test_nothing_depends_on_origin_level_and_order_of_elements() -> None:
    covariance = sampled_covariance(3, INCOHERENT)
    angles = ANGLES + 0.003
    expected = weighted_subspace_fit(
        signal_subspace(covariance, 2), SNAPSHOTS, POSITIONS, angles, WAVENUMBER
    )
    order = np.random.default_rng(4).permutation(15)
    phases = np.exp(1j * np.arange(15.0))
    for other, positions in [
        (covariance, POSITIONS + np.array([3.0, -7.0, 1.0])),
        (1e-9 * covariance, POSITIONS),
        (covariance[np.ix_(order, order)], POSITIONS[order]),
    ]:
        subspace = signal_subspace(other, 2)
        fit = weighted_subspace_fit(subspace, SNAPSHOTS, positions, angles, WAVENUMBER)
        assert np.allclose(fit.score, expected.score, rtol=1e-7)
        assert np.allclose(fit.information, expected.information, rtol=1e-7)
    spoiled = phases[:, None] * covariance * phases.conj()
    wrong = weighted_subspace_fit(
        signal_subspace(spoiled, 2), SNAPSHOTS, POSITIONS, angles, WAVENUMBER
    )
    assert not np.allclose(wrong.score, expected.score, rtol=1e-2)


def test_batch_is_many_single_blocks() -> None:
    covariances, colour = sampled_covariance(5, INCOHERENT, 0.6, batch=(3,)), noise_colour(0.6)
    angles = ANGLES + np.array([[0.0, 0.01], [0.01, 0.0], [-0.01, 0.02]])
    together = weighted_subspace_fit(
        signal_subspace(covariances, 2, colour), SNAPSHOTS, POSITIONS, angles, WAVENUMBER
    )
    for number in range(3):
        alone = weighted_subspace_fit(
            signal_subspace(covariances[number], 2, colour),
            SNAPSHOTS,
            POSITIONS,
            angles[number],
            WAVENUMBER,
        )
        assert np.allclose(together.score[number], alone.score)
        assert np.allclose(together.information[number], alone.information)


def test_noise_alone_says_nothing() -> None:
    covariance = np.eye(15, dtype=complex)
    fit = weighted_subspace_fit(
        signal_subspace(covariance, 2), SNAPSHOTS, POSITIONS, ANGLES, WAVENUMBER
    )
    assert np.abs(fit.information).max() == pytest.approx(0.0, abs=1e-9)
    assert np.abs(fit.score).max() == pytest.approx(0.0, abs=1e-9)
