"""Protects which sources of a covariance count as strong: beside the noise and the largest one."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.array_fit.strong_sources import StrongSources, strong_sources

N_ELEMENTS = 12
POSITIONS = np.column_stack([np.arange(N_ELEMENTS) * 0.5, np.zeros((N_ELEMENTS, 2))])
WAVENUMBER = 2.0 * np.pi
ANGLES = np.radians([-40.0, 35.0])


def found_in(powers: list[float], noise: float = 1.0) -> StrongSources | None:
    """Return what is found where two sources have these powers, noise of this one each element."""
    vectors = steering_vectors(POSITIONS, ANGLES, WAVENUMBER)
    covariance = (vectors * powers) @ vectors.conj().T + noise * np.eye(N_ELEMENTS)
    (found,) = strong_sources(covariance[None], 200, POSITIONS, WAVENUMBER, np.arange(N_ELEMENTS))
    return found


@pytest.mark.parametrize(
    ("powers", "n_strong"),
    [
        ([1000.0, 1000.0], 2),
        ([1000.0, 100.0], 2),  # a tenth of the largest
        ([1000.0, 20.0], 1),  # a fiftieth, though far above the noise
        ([10.0, 1.0], 1),  # above a twentieth, but not above the noise
    ],
)
def test_sources_count_beside_the_largest_and_the_noise(powers: list[float], n_strong: int) -> None:
    found = found_in(powers)
    assert found is not None
    assert found.vectors.shape == (N_ELEMENTS, n_strong)
    np.testing.assert_allclose(np.sort(found.angles), np.sort(ANGLES[:n_strong]), atol=0.02)


def test_noise_alone_has_no_strong_source() -> None:
    assert found_in([0.0, 0.0]) is None
