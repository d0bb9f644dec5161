"""Signal eigenvectors: in the span of the steering vectors, coherent or not, coloured or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.directions.signal_subspace import (
    noise_factor,
    signal_subspace,
    signal_subspace_of,
)
from tests.passive.block_scene import (
    ANGLES,
    COHERENT,
    INCOHERENT,
    ComplexArray,
    exact_covariance,
    noise_colour,
    noise_from_ahead,
    sampled_covariance,
)
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER
from tests.passive.estimate_scene import estimates_of


def outside_the_span(columns: ComplexArray) -> float:
    """Return how far columns lie out of the span of the steering vectors."""
    vectors = steering_vectors(POSITIONS, ANGLES, WAVENUMBER)
    return float(np.abs(columns - vectors @ (np.linalg.pinv(vectors) @ columns)).max())


@pytest.mark.parametrize("correlation", [0.0, 0.3, 0.6, 0.8])
@pytest.mark.parametrize(("sources", "rank"), [(INCOHERENT, 2), (COHERENT, 1)])
def test_vectors_combine_steering_vectors(
    sources: ComplexArray, rank: int, correlation: float
) -> None:
    covariance, colour = exact_covariance(sources, correlation), noise_colour(correlation)
    subspace = signal_subspace(covariance, rank, colour)
    combinations = subspace.steering_combinations()
    assert outside_the_span(combinations) < 1e-10
    assert subspace.noise_power == pytest.approx(0.7)
    # C e = lambda C_v e and e^H C_v e = 1 with e = C_v^-1 b.
    eigenvectors = np.linalg.solve(colour, combinations)
    assert np.allclose(covariance @ eigenvectors, combinations * subspace.eigenvalues)
    assert np.allclose(eigenvectors.conj().T @ combinations, np.eye(rank))
    assert np.all(np.diff(subspace.eigenvalues) < 0.0)


def test_ordinary_eigenvectors_do_not_in_coloured_noise() -> None:
    covariance = exact_covariance(INCOHERENT, 0.6)
    ordinary = signal_subspace(covariance, 2).vectors
    assert outside_the_span(ordinary) > 1e-3
    assert outside_the_span(noise_colour(0.6) @ ordinary) > 1e-2


def test_white_noise_may_be_said_or_not() -> None:
    covariance = sampled_covariance(1, INCOHERENT)
    said = signal_subspace(covariance, 2, noise_colour(0.0))
    unsaid = signal_subspace(covariance, 2)
    assert np.allclose(said.eigenvalues, unsaid.eigenvalues)
    first, second = (s.vectors @ s.vectors.conj().T for s in (said, unsaid))
    assert np.allclose(first, second)


def test_estimates_that_bring_their_eigenvectors_have_the_subspace_of_those_without() -> None:
    covariance = sampled_covariance(4, INCOHERENT)
    without = estimates_of(covariance)
    values, vectors = np.linalg.eigh(covariance)
    known = replace(without, eigenvalues=values[::-1], eigenvectors=vectors[:, ::-1])
    first, second = signal_subspace_of(without, 2), signal_subspace_of(known, 2)
    assert np.array_equal(first.vectors, second.vectors)
    assert np.array_equal(first.eigenvalues, second.eigenvalues)
    assert first.noise_power == second.noise_power
    with pytest.raises(InputError, match="covariance_snapshots"):
        signal_subspace_of(replace(without, covariance=None), 2)


def test_level_of_the_data_scales_the_eigenvalues_only() -> None:
    covariance, colour = sampled_covariance(2, INCOHERENT, 0.6), noise_colour(0.6)
    quiet = signal_subspace(covariance, 2, colour)
    loud = signal_subspace(1e6 * covariance, 2, colour)
    assert np.allclose(loud.eigenvalues, 1e6 * quiet.eigenvalues)
    assert loud.noise_power == pytest.approx(1e6 * float(quiet.noise_power))
    overlap = np.abs((loud.vectors.conj() * quiet.vectors).sum(axis=0))
    assert np.allclose(overlap, 1.0)


def test_batch_is_many_single_covariances() -> None:
    covariances, colour = sampled_covariance(3, INCOHERENT, 0.6, batch=(3,)), noise_colour(0.6)
    together = signal_subspace(covariances, 2, colour)
    for number, covariance in enumerate(covariances):
        alone = signal_subspace(covariance, 2, colour)
        assert np.allclose(together.eigenvalues[number], alone.eigenvalues)
        assert together.noise_power[number] == pytest.approx(float(alone.noise_power))
        assert np.allclose(
            np.abs(together.steering_combinations()[number]), np.abs(alone.steering_combinations())
        )


def test_data_without_noise_keep_a_positive_noise_power() -> None:
    covariance = exact_covariance(INCOHERENT, noise_power=0.0)
    assert 0.0 < signal_subspace(covariance, 2).noise_power < 1e-9
    assert signal_subspace(np.zeros((15, 15), dtype=complex), 2).noise_power > 0.0


@pytest.mark.parametrize("rank", [0, 15])
def test_rank_must_leave_signal_and_noise(rank: int) -> None:
    with pytest.raises(InputError, match="between 1 and 14"):
        signal_subspace(exact_covariance(INCOHERENT), rank)


def test_noise_covariance_must_be_one() -> None:
    skewed = noise_colour(0.6)
    skewed[0, 1] += 0.1
    with pytest.raises(InputError, match="not Hermitian"):
        signal_subspace(exact_covariance(INCOHERENT), 2, skewed)
    indefinite = noise_colour(0.6)
    indefinite[0, 0] = -1.0
    with pytest.raises(InputError, match="not positive definite"):
        signal_subspace(exact_covariance(INCOHERENT), 2, indefinite)


@pytest.mark.parametrize("entry", [(0, 1), (1, 0), (2, 2)])
@pytest.mark.parametrize("skew", [0.1j, -0.1j])
def test_an_imaginary_skew_is_one_too(entry: tuple[int, int], skew: complex) -> None:
    """A diagonal with an imaginary part, or entries that are no conjugates of each other."""
    noise = noise_colour(0.5, 3)
    noise[entry] += skew
    with pytest.raises(InputError, match="not Hermitian"):
        noise_factor(noise)


@pytest.mark.parametrize(("skew", "refused"), [(0.9e-9, False), (1.1e-9, True)])
def test_a_billionth_of_skew_is_rounding(skew: float, refused: bool) -> None:
    noise = 4.0 * noise_colour(0.0, 3)
    noise[0, 1] = 4.0 * skew
    if refused:
        with pytest.raises(InputError, match="not Hermitian"):
            noise_factor(noise)
    else:
        assert np.allclose(noise_factor(noise), 2.0 * np.eye(3), atol=1e-8)


def test_noise_with_a_direction_of_its_own_is_no_signal() -> None:
    """Its covariance is complex; whitened with itself nothing is left of it but unit noise."""
    noise = noise_from_ahead()
    subspace = signal_subspace(3.0 * noise, 2, noise)
    assert subspace.eigenvalues == pytest.approx([3.0, 3.0])
    assert subspace.noise_power == pytest.approx(3.0)
    assert np.allclose(noise_factor(noise) @ noise_factor(noise).conj().T, noise)
