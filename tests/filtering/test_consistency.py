"""Protects the measure of consistency and its band, by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sonar_tracking.filtering.consistency import chi_square_band, normalised_squared


def test_squares_are_taken_in_units_of_the_covariance_and_per_dimension() -> None:
    errors = np.array([[3.0, 4.0], [1.0, 1.0], [np.nan, 0.0]])
    covariances = np.array([np.diag([9.0, 4.0]), [[2.0, 1.0], [1.0, 2.0]], np.eye(2)])
    squared = normalised_squared(errors, covariances)
    assert squared[:2] == pytest.approx([(1.0 + 4.0) / 2.0, (2.0 / 3.0) / 2.0])
    assert np.isnan(squared[2])


@pytest.mark.parametrize(("dimension", "count"), [(2, 1), (1, 2)])
def test_the_band_of_two_degrees_of_freedom_is_that_of_an_exponential(
    dimension: int, count: int
) -> None:
    low, high = chi_square_band(dimension, count)
    assert (low, high) == pytest.approx((-math.log(0.975), -math.log(0.025)))
    low, high = chi_square_band(dimension, count, 0.5)
    assert (low, high) == pytest.approx((-math.log(0.75), -math.log(0.25)))
