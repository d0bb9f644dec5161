"""Protects the fused measurement and its variance, by sums that can be done by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.directions.measurement_fusion import (
    correlated_variance_ratio,
    forgetting_factor_of,
    fused_measurement,
    independent_variance_ratio,
    mean_age,
)


def test_the_fused_measurement_is_the_mean_over_the_subspaces() -> None:
    assert fused_measurement(np.array([[1.0, 2.0], [3.0, 6.0], [5.0, 1.0]])).tolist() == [3.0, 3.0]


def test_variance_of_the_mean_of_three_neighbours() -> None:
    """Nine pairs: three the same, four one snapshot apart, two two apart."""
    offsets = [-0.1, 0.0, 0.1]
    assert correlated_variance_ratio(offsets, 0.1, 0.5) == pytest.approx((3.0 + 2.0 + 0.5) / 9.0)
    assert correlated_variance_ratio(offsets, 0.05, 0.5) == pytest.approx((3.0 + 1.0 + 0.125) / 9.0)
    assert correlated_variance_ratio([0.3], 0.1, 0.5) == 1.0
    assert independent_variance_ratio(4) == 0.25


@pytest.mark.parametrize(("beta", "snapshots", "age"), [(0.5, 3.0, 1.0), (0.75, 7.0, 3.0)])
def test_the_window_of_a_forgetting_factor(beta: float, snapshots: float, age: float) -> None:
    assert forgetting_factor_of(snapshots) == pytest.approx(beta)
    assert mean_age(beta) == pytest.approx(age)
    weights = beta ** np.arange(200)
    assert np.sum(weights * np.arange(200)) / np.sum(weights) == pytest.approx(age)
    assert np.sum(weights) ** 2 / np.sum(weights**2) == pytest.approx(snapshots)
