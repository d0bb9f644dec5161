"""Protects what an estimate tells of sources at known angles: powers, variances, resolution."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.geometry import beamwidth, line_array, steering_vectors
from sonar_tracking.passive.directions.sources_at_angles import (
    PRIOR_VARIANCE,
    estimated_sources,
    fisher_variance,
    power_ratios,
    signal_to_noise_ratios,
    unresolved,
)
from sonar_tracking.passive.performance.fisher_information import stochastic_fisher_information
from tests.passive.bearings.test_track_existence import ANGLES, estimates_of
from tests.passive.block_scene import INCOHERENT, noise_colour, noise_from_ahead
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER

TWO = ANGLES[:2]
SEEN = replace(estimates_of(INCOHERENT), noise_power=np.array(0.7))
"""Sources of power 1 and 0.5 in noise of power 0.7, exactly."""


def test_the_prior_of_a_bearing_of_which_nothing_is_said_is_thirty_degrees() -> None:
    assert np.degrees(np.sqrt(PRIOR_VARIANCE)) == pytest.approx(30.0)


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_sources_and_their_ratios_are_found_in_the_exact_covariance(correlation: float) -> None:
    colour = noise_colour(correlation)
    seen = replace(
        estimates_of(INCOHERENT, correlation), noise_power=np.array(0.7), noise_covariance=colour
    )
    sources = estimated_sources(seen, TWO, np.zeros(2))
    assert sources == pytest.approx(INCOHERENT, abs=1e-9)
    assert signal_to_noise_ratios(seen, sources, (2,)) == pytest.approx([1.0 / 0.7, 0.5 / 0.7])


def test_moving_sources_are_looked_for_where_they_were_in_the_middle_of_the_block() -> None:
    rates = np.array([0.1, -0.2])
    late = replace(SEEN, covariance_time_offset=-0.25)
    assert estimated_sources(late, TWO + 0.25 * rates, rates) == pytest.approx(INCOHERENT, abs=1e-9)


def test_without_covariance_or_noise_nothing_is_said() -> None:
    for unknown in (replace(SEEN, covariance=None), replace(SEEN, noise_power=np.array(np.nan))):
        assert estimated_sources(unknown, TWO, np.zeros(2)) is None
    assert np.isnan(signal_to_noise_ratios(SEEN, None, (3, 2))).all()
    assert np.isnan(fisher_variance(SEEN, TWO, None, 100.0)).tolist() == [True, True]
    assert np.isnan(power_ratios(replace(SEEN, covariance=None), TWO)).tolist() == [True, True]
    for power in (0.0, np.nan):
        assert np.isnan(power_ratios(replace(SEEN, noise_power=np.array(power)), TWO)).all()
    assert power_ratios(SEEN, np.empty(0)).shape == (0,)


def test_a_silent_array_has_a_noise_of_a_trillionth_of_its_power() -> None:
    """So that ratios and variances of data without noise stay finite."""
    vectors = steering_vectors(POSITIONS, TWO, WAVENUMBER)
    pure = replace(
        SEEN, covariance=vectors @ INCOHERENT @ vectors.conj().T, noise_power=np.array(0.0)
    )
    ratios = signal_to_noise_ratios(pure, INCOHERENT, (2,))
    assert ratios == pytest.approx([1.0 / 1.5e-12, 0.5 / 1.5e-12])
    assert np.all(fisher_variance(pure, TWO, INCOHERENT, 100.0) > 0.0)


def test_the_variance_is_the_diagonal_of_the_inverse_with_the_prior() -> None:
    information = stochastic_fisher_information(
        POSITIONS, TWO, WAVENUMBER, INCOHERENT, np.array(0.7), 50.0
    )
    expected = np.diag(np.linalg.inv(information + np.eye(2) / PRIOR_VARIANCE))
    assert fisher_variance(SEEN, TWO, INCOHERENT, 50.0) == pytest.approx(expected)
    silent = fisher_variance(SEEN, TWO, np.zeros((2, 2), complex), 50.0)
    assert silent == pytest.approx([PRIOR_VARIANCE] * 2)


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_power_along_an_angle_is_that_of_its_source_over_the_noise(correlation: float) -> None:
    """By the row w of the pseudo-inverse: w^H R w / |w|^2, in units of the noise."""
    colour = noise_colour(correlation)
    seen = replace(
        estimates_of(INCOHERENT, correlation), noise_power=np.array(0.7), noise_covariance=colour
    )
    factor = np.linalg.cholesky(colour)
    white = np.linalg.solve(factor, steering_vectors(POSITIONS, ANGLES, WAVENUMBER))
    rows = np.linalg.pinv(white)
    powers = np.array([1.0, 0.5, 0.0])
    expected = powers / (np.abs(rows) ** 2).sum(axis=1) / 0.7 + 1.0
    assert power_ratios(seen, ANGLES) == pytest.approx(expected)


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_bearings_nearer_than_a_share_of_the_beam_are_unresolved(share: float) -> None:
    """In sine, so that beams widen towards endfire."""
    limit = share * beamwidth(line_array(15, 0.5), WAVENUMBER)
    for middle in (0.0, 0.8):
        near, far = (np.arcsin(middle + f * limit) for f in (0.999, 1.001))
        found = unresolved(np.array([np.arcsin(middle)]), np.array([near, far, -1.5]), SEEN, share)
        assert found.tolist() == [[True, False, False]]
    default = unresolved(np.zeros(1), np.arcsin([0.4 * limit / share, 0.6 * limit / share]), SEEN)
    assert default.tolist() == [[True, False]]


def test_noise_from_ahead_has_the_power_of_noise_everywhere() -> None:
    noise = noise_from_ahead()
    seen = replace(SEEN, covariance=0.7 * noise, noise_covariance=noise)
    assert power_ratios(seen, ANGLES) == pytest.approx([1.0, 1.0, 1.0])
