"""Protects that a station's constant error counts once in a trial, and not once a bearing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from sonar_tracking.tma.stations.lasting_error import NO_ERROR, LastingError

DEVIATION, WHITE = 0.5, 1.0
"""Of the constant error and of the independent ones, degrees."""


def evidence(innovations: np.ndarray, start: LastingError) -> tuple[float, LastingError]:
    """Return the log density of innovations, one after the other, and what is known then."""
    total, known = 0.0, start
    for one in innovations.tolist():
        spread = WHITE**2 + known.variance
        without = float(norm.logpdf(one, 0.0, WHITE))
        shifted = float(norm.logpdf(one, known.mean, np.sqrt(spread)))
        total += known.density(without, shifted)
        known = known.learnt(without, shifted, one - known.mean, spread)
    return total, known


@pytest.mark.parametrize("error", [0.0, 0.8])
def test_the_evidence_is_that_of_all_innovations_together(error: float) -> None:
    """By hand: a mixture of independent values, and of values with a common error."""
    found = error + WHITE * np.random.default_rng(1).standard_normal(50)
    log_odds = float(np.log(0.1))
    total, known = evidence(found, LastingError(0.0, DEVIATION**2, log_odds))
    common = WHITE**2 * np.eye(50) + DEVIATION**2
    with_error = multivariate_normal.logpdf(found, np.zeros(50), common)
    without = np.sum(norm.logpdf(found, 0.0, WHITE))
    assert total == pytest.approx(np.logaddexp(without, log_odds + with_error) - np.log(1.1))
    assert known.log_odds == pytest.approx(log_odds + with_error - without)
    assert (known.log_odds > 0.0) == (error > 0.0)
    assert known.variance == pytest.approx(1.0 / (50.0 / WHITE**2 + DEVIATION**-2))


def test_without_an_error_only_the_plain_density_counts() -> None:
    assert NO_ERROR.density(-1.5, 7.0) == pytest.approx(-1.5)
    assert NO_ERROR.learnt(-1.5, -1.5, 0.3, 1.0) == NO_ERROR


def test_an_azimuth_that_nothing_explains_tells_nothing_of_the_size_of_the_error() -> None:
    before = LastingError(0.2, 0.1, -1.0)
    after = before.learnt(-4.6, -4.6, 0.0, 0.0)
    assert (after.mean, after.variance) == (before.mean, before.variance)
