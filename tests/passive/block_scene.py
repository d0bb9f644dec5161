"""Block covariances of a line array of 15 elements, exact and sampled: shared by the tests."""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER, circular_noise

ANGLES = np.deg2rad([-10.0, 2.0])
INCOHERENT = np.array([[1.0, 0.0], [0.0, 0.5]], dtype=complex)
COHERENT = np.outer([1.0, 0.7j], np.conj([1.0, 0.7j]))
"""Source covariances of rank 2 and 1."""


def noise_colour(correlation: float, n_elements: int = 15) -> ComplexArray:
    """Return the noise covariance with entries correlation^|i - j|, trace n_elements."""
    index = np.arange(n_elements)
    return np.power(correlation, np.abs(index[:, None] - index)).astype(complex)


def noise_from_ahead(n_elements: int = 15) -> ComplexArray:
    """Return a noise covariance with phases: it comes more from one side than from the other."""
    index = np.arange(n_elements)
    return noise_colour(0.8, n_elements) * np.exp(0.5j * (index[:, None] - index))


def exact_covariance(
    sources: ComplexArray,
    correlation: float = 0.0,
    noise_power: float = 0.7,
    angles: FloatArray = ANGLES,
) -> ComplexArray:
    """Return S P S^H + noise_power C_v."""
    vectors = steering_vectors(POSITIONS, angles, WAVENUMBER)
    return vectors @ sources @ vectors.conj().T + noise_power * noise_colour(correlation)


def sampled_covariance(
    seed: int,
    sources: ComplexArray,
    correlation: float = 0.0,
    n_snapshots: int = 64,
    batch: tuple[int, ...] = (),
) -> ComplexArray:
    """Return the covariance of Gaussian snapshots whose expectation is the exact one."""
    generator = np.random.default_rng(seed)
    factor = np.linalg.cholesky(exact_covariance(sources, correlation))
    data = circular_noise(generator, *batch, n_snapshots, 15) @ factor.T
    return np.asarray(np.swapaxes(data, -1, -2) @ data.conj() / n_snapshots)
