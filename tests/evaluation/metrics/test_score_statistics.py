"""The figures every score has."""

import pytest

from sonar_tracking.evaluation.metrics.score_statistics import CHI_SQUARE_BAND, nees_band


@pytest.mark.slow
@pytest.mark.parametrize("dimension", CHI_SQUARE_BAND)
def test_the_band_of_an_error_is_that_of_chi_square(dimension: int) -> None:
    from scipy.stats import chi2  # which no other test should wait for

    quantiles = chi2.ppf([0.025, 0.975], dimension) / dimension
    assert nees_band(dimension) == tuple(quantiles)
