"""Which MUSIC bearings are new: those with power of their own that belong to no track.

The steering vectors of 15 elements half a wavelength apart are orthogonal where sines differ by
2 k / 15. A source of ratio s to unit noise then has the power 1 + 15 s along its bearing.
"""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.track_start.new_bearings import LEAST_POWER_RATIO, new_bearings
from tests.passive.block_scene import noise_colour
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER
from tests.passive.estimate_scene import estimates_of

NOBODY = np.empty(0)
LEAST = (LEAST_POWER_RATIO - 1.0) / 15.0
"""Ratio of the weakest source that is believed: -10.8 dB."""


def covariance_of(sines: list[float], sources: np.ndarray, noise: np.ndarray) -> np.ndarray:
    vectors = steering_vectors(POSITIONS, np.arcsin(sines), WAVENUMBER)
    return np.asarray(vectors @ sources @ vectors.conj().T + noise)


def found(
    sines: list[float], ratios: list[float], tracked: np.ndarray = NOBODY, smooth: bool = False
) -> list[float]:
    """Return the sines of the new bearings of incoherent sources."""
    covariance = covariance_of(sines, np.diag(ratios), np.eye(15))
    estimates = estimates_of(covariance)
    angles, variances = new_bearings(estimates, covariance, len(sines), tracked, smooth)
    assert len(angles) == len(variances)
    return np.sin(angles).round(6).tolist()


def test_the_weakest_source_is_one_of_minus_10_8_db() -> None:
    assert 10.0 * np.log10(LEAST) == pytest.approx(-10.8, abs=0.01)
    sines = [0.0, 8.0 / 15.0]
    assert found(sines, [1.0, 1.01 * LEAST]) == pytest.approx(sines, abs=1e-6)
    assert found(sines, [1.0, 0.99 * LEAST]) == [0.0]
    assert found(sines, [0.99 * LEAST, 0.99 * LEAST]) == []


def test_weak_ones_near_each_other_are_believed() -> None:
    """A fifth of the noise each; the part orthogonal to the other one is below the limit."""
    apart = 0.05  # the beamwidth is 1 / 7
    alike = np.sin(7.5 * np.pi * apart) / np.sin(0.5 * np.pi * apart) / 15.0
    assert 1.0 + 0.2 * 15.0 * (1.0 - alike**2) < LEAST_POWER_RATIO
    assert found([0.2, 0.2 + apart], [0.2, 0.2]) == pytest.approx([0.2, 0.25], abs=1e-5)


def test_a_bearing_nearer_than_half_a_beamwidth_to_a_track_is_that_track() -> None:
    sines, half = [0.0, 8.0 / 15.0], 0.5 / 7.0
    assert found(sines, [1.0, 1.0], np.arcsin([0.99 * half])) == pytest.approx(sines[1:])
    assert found(sines, [1.0, 1.0], np.arcsin([1.01 * half])) == pytest.approx(sines, abs=1e-6)
    assert found(sines, [1.0, 1.0], np.arcsin([0.0, 0.5])) == []


def test_power_that_a_track_has_already_is_nothing_new() -> None:
    """A peak on the flank of a tracked source, half of a source by itself."""
    track, peak = 0.0, 0.1
    alike = np.sin(7.5 * np.pi * peak) / np.sin(0.5 * np.pi * peak) / 15.0
    own = (LEAST_POWER_RATIO - 1.0) / (15.0 * (1.0 - alike**2))
    assert found([track, peak], [5.0, 0.98 * own], np.array([0.0])) == []
    assert found([track, peak], [5.0, 1.02 * own], np.array([0.0])) == pytest.approx([peak])


def test_coherent_sources_need_the_smoothed_covariance() -> None:
    sines, sources = [-4.0 / 15.0, 6.0 / 15.0], np.outer([1.0, 0.8j], [1.0, -0.8j])
    for colour in (None, noise_colour(0.3)):
        noise = np.eye(15) if colour is None else colour
        covariance = covariance_of(sines, sources, noise)
        estimates = estimates_of(covariance, noise_covariance=colour)
        smoothed = new_bearings(estimates, covariance, 2, NOBODY, True)[0]
        assert np.sin(smoothed) == pytest.approx(sines, abs=1e-5)
        raw = np.sin(new_bearings(estimates, covariance, 2, NOBODY, False)[0])
        assert raw.shape != (2,) or np.abs(raw - sines).max() > 1e-3


def test_variances_are_those_of_the_snapshots() -> None:
    """At broadside, one source: 6 (1 + 1 / (15 s)) / (N s k^2 d^2 15 (15^2 - 1))."""
    covariance = covariance_of([0.0], np.eye(1), np.eye(15))
    variance = new_bearings(estimates_of(covariance), covariance, 1, NOBODY, False)[1]
    bound = 6.0 * (1.0 + 1.0 / 15.0) / (100.0 * np.pi**2 * 15.0 * 224.0)
    assert variance == pytest.approx([bound], rel=1e-3)


def test_without_noise_power_nothing_is_told() -> None:
    covariance = covariance_of([0.0], np.eye(1), np.eye(15))
    estimates = estimates_of(covariance, noise_power=np.array(np.nan))
    assert [len(one) for one in new_bearings(estimates, covariance, 1, NOBODY, False)] == [0, 0]


@pytest.mark.parametrize("n_sources", [9, 10])
def test_as_many_sources_as_a_sub_array_has_elements_need_the_whole_array(n_sources: int) -> None:
    """Ten of fifteen: a smoothed covariance of ten elements would have no noise left."""
    sines = [2.0 * k / 15.0 for k in range(-5, n_sources - 5)]
    assert found(sines, [1.0] * n_sources, smooth=True) == pytest.approx(sines, abs=1e-5)
