"""Projection fit: gradient, equations by the letter, no bias in coloured noise, capped steps."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.directions.projection_fit import (
    LARGEST_STEP,
    ProjectionProblem,
    fits_below,
    projection_fit,
)
from sonar_tracking.passive.directions.signal_subspace import signal_subspace
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

CASES = [(INCOHERENT, 2, 0.0), (INCOHERENT, 2, 0.6), (COHERENT, 1, 0.0), (COHERENT, 1, 0.6)]


def problem_of(covariance: ComplexArray, rank: int, correlation: float) -> ProjectionProblem:
    """Return the fit to the signal eigenvectors of a covariance."""
    subspace = signal_subspace(covariance, rank, noise_colour(correlation))
    return ProjectionProblem(subspace.steering_combinations(), POSITIONS, WAVENUMBER)


def fit_by_the_letter(combinations: ComplexArray, theta: FloatArray, steps: int) -> FloatArray:
    """Return the angles from the axis after some steps, written equation by equation."""
    p = np.arange(15)[:, None]

    def parts(theta: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        S = np.exp(-1j * np.pi * p * np.cos(theta))
        L = 1j * np.pi * p * np.sin(theta) * S
        return S, L, np.eye(15) - S @ np.linalg.inv(S.conj().T @ S) @ S.conj().T

    def cost(theta: FloatArray) -> float:
        return float(np.sum(np.abs(parts(theta)[2] @ combinations) ** 2))

    for _ in range(steps):
        S, L, P = parts(theta)
        A, a = np.zeros((2, 2)), np.zeros(2)
        for e in combinations.T:
            y = np.linalg.inv(S.conj().T @ S) @ S.conj().T @ e
            C = (P @ L) * y
            A, a = A + (C.conj().T @ C).real, a + (C.conj().T @ (P @ e)).real
        delta = np.linalg.solve(A, a)
        delta = delta * min(1.0, np.deg2rad(0.5) / np.abs(delta).max())
        for halving in range(9):
            if cost(theta + 0.5**halving * delta) < cost(theta):
                theta = theta + 0.5**halving * delta
                break
    return theta


@pytest.mark.parametrize(("sources", "rank", "correlation"), CASES)
def test_slope_is_the_gradient(sources: ComplexArray, rank: int, correlation: float) -> None:
    problem = problem_of(sampled_covariance(1, sources, correlation), rank, correlation)
    angles = ANGLES + np.deg2rad([0.7, -0.5])
    _, slope = problem.curvature_and_slope(angles)
    step = 1e-6
    for target in range(2):
        offset = step * np.eye(2)[target]
        difference = problem.error(angles + offset) - problem.error(angles - offset)
        assert -2.0 * slope[target] == pytest.approx(float(difference) / (2.0 * step), rel=1e-6)


@pytest.mark.parametrize(("sources", "rank", "correlation"), CASES)
def test_steps_are_the_published_ones(sources: ComplexArray, rank: int, correlation: float) -> None:
    problem = problem_of(sampled_covariance(2, sources, correlation), rank, correlation)
    predicted = ANGLES + np.deg2rad([1.1, -0.4])
    fitted = projection_fit(problem, predicted)
    letter = fit_by_the_letter(problem.combinations, predicted + 0.5 * np.pi, 3)
    assert np.rad2deg(np.abs(fitted + 0.5 * np.pi - letter)).max() < 1e-10


@pytest.mark.parametrize("correlation", [0.0, 0.3, 0.6, 0.8])
@pytest.mark.parametrize(("sources", "rank"), [(INCOHERENT, 2), (COHERENT, 1)])
def test_no_bias_on_the_exact_covariance(
    sources: ComplexArray, rank: int, correlation: float
) -> None:
    problem = problem_of(exact_covariance(sources, correlation), rank, correlation)
    fitted = projection_fit(problem, ANGLES + np.deg2rad([0.6, -0.8]), steps=50)
    assert np.rad2deg(np.abs(fitted - ANGLES)).max() < 1e-6


@pytest.mark.parametrize(
    ("correlation", "bias"), [(0.3, (0.34, -0.09)), (0.6, (1.27, -0.37)), (0.8, (2.56, -0.81))]
)
def test_ordinary_eigenvectors_would_bias_it(correlation: float, bias: tuple[float, float]) -> None:
    # The paper's text multiplies ordinary eigenvectors by the noise covariance.
    covariance = exact_covariance(np.eye(2, dtype=complex), correlation, 1.0)
    ordinary = signal_subspace(covariance, 2).vectors
    coloured = noise_colour(correlation) @ ordinary
    coloured = coloured / np.linalg.norm(coloured, axis=0)
    problem = ProjectionProblem(coloured, POSITIONS, WAVENUMBER)
    fitted = projection_fit(problem, ANGLES, steps=50)
    assert np.rad2deg(fitted - ANGLES) == pytest.approx(bias, abs=0.006)


def test_error_drops_and_steps_are_capped() -> None:
    problem = problem_of(sampled_covariance(3, INCOHERENT, batch=(20,)), 2, 0.0)
    offsets = np.deg2rad(np.random.default_rng(4).uniform(-6.0, 6.0, (20, 2)))
    predicted = ANGLES + offsets
    fitted = projection_fit(problem, predicted)
    assert np.all(problem.error(fitted) <= problem.error(predicted))
    assert np.abs(fitted - predicted).max() <= 3.0 * LARGEST_STEP * (1.0 + 1e-12)
    moved_once = projection_fit(problem, predicted, steps=1) - predicted
    assert np.abs(moved_once).max() <= LARGEST_STEP * (1.0 + 1e-12)


def test_batch_is_many_single_fits() -> None:
    covariances = sampled_covariance(5, COHERENT, 0.6, batch=(4,))
    offsets = np.deg2rad(np.random.default_rng(6).uniform(-1.0, 1.0, (4, 2)))
    together = projection_fit(problem_of(covariances, 1, 0.6), ANGLES + offsets)
    for number in range(4):
        alone = projection_fit(problem_of(covariances[number], 1, 0.6), ANGLES + offsets[number])
        assert np.abs(together[number] - alone).max() < 1e-12


def test_sets_are_found_of_which_one_of_several_fits_is_below_an_error() -> None:
    problem = problem_of(sampled_covariance(8, INCOHERENT, batch=(3,)), 2, 0.0)
    offsets = np.deg2rad([[4.0, -4.0], [1.0, -1.0], [-9.0, 9.0]])
    fitted = [problem.error(projection_fit(problem, ANGLES + each)) for each in offsets]
    least = np.min(fitted, axis=0)
    starts = np.broadcast_to(ANGLES + offsets, (3, *offsets.shape))
    for shares in ([0.99, 1.01, 0.99], [1.01, 1.01, 0.99]):
        found = fits_below(problem, starts, np.array(shares) * least)
        np.testing.assert_array_equal(found, np.array(shares) > 1.0)


def test_equal_predictions_are_no_harm() -> None:
    problem = problem_of(sampled_covariance(7, INCOHERENT), 2, 0.0)
    fitted = projection_fit(problem, np.deg2rad([-4.0, -4.0]))
    assert np.isfinite(fitted).all()
    assert np.abs(fitted - np.deg2rad(-4.0)).max() <= 3.0 * LARGEST_STEP * (1.0 + 1e-12)


def test_more_targets_than_rank_are_found_and_more_than_unique_are_no_harm() -> None:
    angles = np.deg2rad([-40.0, -15.0, 10.0, 45.0])
    weights = np.array([1.0, 0.8j, -0.6, 0.9])
    covariance = exact_covariance(np.outer(weights, weights.conj()), angles=angles)
    problem = problem_of(covariance, 1, 0.0)
    fitted = projection_fit(problem, angles + np.deg2rad([0.5, -0.5, 0.4, -0.4]), steps=50)
    assert np.rad2deg(np.abs(fitted - angles)).max() < 1e-6
    many = np.arcsin(np.linspace(-0.9, 0.9, 14))
    assert np.isfinite(projection_fit(problem, many)).all()
