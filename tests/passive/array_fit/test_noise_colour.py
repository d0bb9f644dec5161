"""The colour of noise that nobody has told is found, white noise stays white."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sonar_tracking.filtering.eigenpairs import eigenpairs
from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.noise_colour import NoiseColour, updated_colours
from sonar_tracking.passive.array_fit.noise_evidence import noise_evidence
from sonar_tracking.passive.array_fit.noise_models import DistanceNoise, LineNoise, noise_model
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from tests.passive.crossing_scene import WAVENUMBER, circular_noise

ANGLES = np.deg2rad([-20.0, 15.0])


def exponential(n_elements: int, correlation: float, phase: float = 0.0) -> ComplexArray:
    lags = np.arange(n_elements)[:, None] - np.arange(n_elements)
    return np.asarray(np.power(correlation, np.abs(lags)) * np.exp(1j * phase * lags))


def alternating(n_elements: int) -> ComplexArray:
    lags = np.arange(n_elements)[:, None] - np.arange(n_elements)
    return np.asarray(np.power(0.6, np.abs(lags)) * (-1.0) ** lags + 0j)


def moving_average(n_elements: int) -> ComplexArray:
    lags = np.arange(n_elements)[:, None] - np.arange(n_elements)
    return np.asarray(np.eye(n_elements) + 0.4 * (np.abs(lags) == 1) + 0j)


def covariances(
    generator: np.random.Generator, positions: FloatArray, noise: ComplexArray, count: int
) -> list[ComplexArray]:
    """Return sample covariances of 100 snapshots of two sources of 0 dB."""
    vectors, factor = steering_vectors(positions, ANGLES, WAVENUMBER), np.linalg.cholesky(noise)
    found = []
    for _ in range(count):
        sources = circular_noise(generator, 100, 2) @ vectors.T
        found.append(
            sample_covariance(sources + circular_noise(generator, 100, len(noise)) @ factor.T)
        )
    return found


def colour_after(data: list[ComplexArray], positions: FloatArray) -> NoiseColour:
    model, colour = noise_model(positions), NoiseColour()
    assert model is not None
    elements = np.arange(len(positions))
    for covariance in data:
        judged = JudgedCovariance(
            covariance, covariance, 100, positions, WAVENUMBER, elements, None, model
        )
        (colour,) = updated_colours([(colour, judged, 1.0)])
    return colour


@pytest.mark.parametrize("n_elements", [8, 15, 24])
def test_white_noise_stays_white(n_elements: int) -> None:
    positions = line_array(n_elements, 0.5)
    for seed in range(4):
        data = covariances(np.random.default_rng(seed), positions, exponential(n_elements, 0.0), 20)
        assert not colour_after(data, positions).coloured


@pytest.mark.parametrize("n_elements", [8, 15])
@pytest.mark.parametrize(
    "noise",
    [
        lambda n: exponential(n, 0.3),
        lambda n: exponential(n, 0.6),
        lambda n: exponential(n, 0.6, 0.9),
        alternating,
        moving_average,
    ],
)
def test_colour_is_found_and_the_sources_are_two(
    n_elements: int, noise: Callable[[int], ComplexArray]
) -> None:
    positions, truth = line_array(n_elements, 0.5), noise(n_elements)
    data = covariances(np.random.default_rng(7), positions, truth, 12)
    colour, model = colour_after(data, positions), noise_model(positions)
    assert model is not None
    assert colour.coloured
    assert np.abs(model.covariance(colour.parameters) - truth).max() < 0.15
    evidence = noise_evidence(np.stack(data[-4:]), 100, model, colour.parameters)
    assert evidence.ranks.tolist() == [2] * 4


def test_noise_that_becomes_white_again_is_taken_for_white() -> None:
    positions, generator = line_array(15, 0.5), np.random.default_rng(1)
    data = covariances(generator, positions, exponential(15, 0.5), 5)
    assert colour_after(data, positions).coloured
    data += covariances(generator, positions, exponential(15, 0.0), 60)
    assert not colour_after(data, positions).coloured


def test_noise_of_an_array_that_is_no_line_is_found() -> None:
    around = 2.0 * np.pi * np.arange(12) / 12
    positions = np.stack([np.cos(around), np.sin(around), np.zeros(12)], axis=-1)
    distances = np.linalg.norm(positions[:, None] - positions, axis=-1)
    truth = np.exp(-distances / 0.9) + 0j
    data = covariances(np.random.default_rng(3), positions, truth, 12)
    colour, model = colour_after(data, positions), noise_model(positions)
    assert isinstance(model, DistanceNoise)
    assert colour.coloured
    assert np.abs(model.covariance(colour.parameters) - truth).max() < 0.15


def test_a_line_with_a_gap_has_the_noise_of_the_whole_line() -> None:
    whole = line_array(15, 0.5)
    kept = np.arange(15) != 4
    model, part = noise_model(whole), noise_model(whole[kept])
    assert isinstance(model, LineNoise)
    assert isinstance(part, LineNoise)
    parameters = np.random.default_rng(0).normal(0.0, 0.3, model.n_parameters)
    noise = model.covariance(parameters)
    assert np.allclose(part.covariance(parameters), noise[np.ix_(kept, kept)])
    assert np.allclose(noise, noise.conj().T)
    assert np.trace(noise).real == pytest.approx(15.0)


@pytest.mark.parametrize("positions", [line_array(8, 0.5), np.random.default_rng(2).random((9, 3))])
def test_score_is_the_gradient_of_the_likelihood_of_all_noise(positions: FloatArray) -> None:
    """Without sources the likelihood is -N (ln det C_v + M ln sigma^2), sigma^2 its own maximum."""
    model = noise_model(positions)
    assert model is not None
    generator = np.random.default_rng(4)
    data = circular_noise(generator, 300, len(positions))
    covariance = sample_covariance(data)
    parameters = np.abs(generator.normal(0.0, 0.1, model.n_parameters))

    def likelihood(at: FloatArray) -> float:
        noise = model.covariance(at)
        power = np.trace(np.linalg.solve(noise, covariance)).real / len(noise)
        return float(-300 * (np.linalg.slogdet(noise)[1] + len(noise) * np.log(power)))

    evidence = noise_evidence(covariance[None], 300, model, parameters, most_sources=0)
    for number, step in enumerate(np.eye(model.n_parameters) * 1e-5):
        slope = (likelihood(parameters + step) - likelihood(parameters - step)) / 2e-5
        assert evidence.score[0, number] == pytest.approx(slope, rel=1e-4, abs=1e-3)


def test_known_eigenpairs_say_the_same() -> None:
    positions = line_array(15, 0.5)
    data = covariances(np.random.default_rng(5), positions, exponential(15, 0.0), 3)
    model = noise_model(positions)
    assert model is not None
    white, pairs = np.zeros(model.n_parameters), eigenpairs(np.stack(data))
    asked = noise_evidence(np.stack(data), 100, model, white)
    known = noise_evidence(np.stack(data), 100, model, white, eigenpairs=pairs)
    assert np.array_equal(asked.score, known.score)
    assert np.array_equal(asked.description, known.description)
