"""Errors of the steering vectors: a floor under which echoes of strong sources are no sources."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.sources.steering_error import with_steering_error
from sonar_tracking.passive.subspaces.covariance_summary import (
    CovarianceSummary,
    summarise_windows,
)
from tests.passive.crossing_scene import block_of, circular_noise

N_ELEMENTS, N_SNAPSHOTS = 8, 64
POSITIONS = line_array(N_ELEMENTS, 0.5)
WAVENUMBER = 2.0 * np.pi
ECHOES_DEG = (-65.0, -35.0, 5.0, 50.0, 75.0)


def echoing(
    generator: np.random.Generator, angles_deg: tuple[float, ...], echo_db: float
) -> np.ndarray:
    """Return snapshots of sources 20 dB over the noise, each with late echoes."""
    data = circular_noise(generator, N_SNAPSHOTS, N_ELEMENTS)
    direct = steering_vectors(POSITIONS, np.deg2rad(angles_deg), WAVENUMBER)
    echoes = steering_vectors(POSITIONS, np.deg2rad(ECHOES_DEG), WAVENUMBER)
    for vector in direct.T:
        data = data + 10.0 * circular_noise(generator, N_SNAPSHOTS, 1) * vector
        late = circular_noise(generator, N_SNAPSHOTS, len(ECHOES_DEG))
        data = data + 10.0 ** (1.0 + echo_db / 20.0) * late @ echoes.T
    return np.asarray(data)


def summary_of(data: np.ndarray, steering_error: float) -> CovarianceSummary:
    header = block_of(data[:0], 0, element_positions=POSITIONS)
    return summarise_windows(data[None], 0, header, None, 0.0, steering_error)[0]


def test_the_floor_is_a_share_of_the_received_power_in_the_colour_of_the_noise() -> None:
    covariance = np.diag([1.0, 2.0, 6.0]).astype(complex)
    white = with_steering_error(covariance, 0.5)
    assert np.allclose(white - covariance, 0.25 * 3.0 * np.eye(3))
    colour = np.array([[1.0, 0.5, 0.0], [0.5, 1.0, 0.5], [0.0, 0.5, 1.0]], complex)
    assert np.allclose(with_steering_error(covariance, 0.5, colour) - covariance, 0.75 * colour)
    assert with_steering_error(covariance, 0.0) is covariance


@pytest.mark.parametrize("angles_deg", [(20.0,), (-10.0, 20.0)])
def test_echoes_are_no_sources_where_they_are_expected(angles_deg: tuple[float, ...]) -> None:
    generator = np.random.default_rng(1)
    for _ in range(10):
        data = echoing(generator, angles_deg, -15.0)
        believed, expected = summary_of(data, 0.0), summary_of(data, 0.4)
        assert believed.rank > len(angles_deg), "echoes later than a snapshot are sources to MDL"
        assert expected.rank == expected.source_count == len(angles_deg)


def test_eigenvalues_are_those_of_the_covariance_also_in_coloured_noise() -> None:
    data = echoing(np.random.default_rng(2), (20.0,), -15.0)
    distance = np.abs(np.subtract.outer(np.arange(N_ELEMENTS), np.arange(N_ELEMENTS)))
    colour = (0.6**distance).astype(complex)
    for noise in (None, colour):
        header = block_of(data[:0], 0, element_positions=POSITIONS, noise_covariance=noise)
        whitening = (
            None if noise is None else np.linalg.inv(np.linalg.cholesky(noise)).astype(complex)
        )
        summary = summarise_windows(data[None], 0, header, whitening, 0.0, 0.3)[0]
        assert summary.covariance is not None
        assert np.allclose(np.linalg.eigvalsh(summary.covariance)[::-1], summary.eigenvalues)
        white = summary.covariance
        if whitening is not None:
            white = whitening @ white @ whitening.conj().T
        values = np.linalg.eigvalsh(white)[::-1]
        n_signals = max(summary.rank, summary.source_count)
        assert summary.noise_power == pytest.approx(values[n_signals:].mean())
