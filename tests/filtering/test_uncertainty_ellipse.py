"""The ellipse holds what it says it holds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.filtering.uncertainty_ellipse import UncertaintyEllipse, uncertainty_ellipse

lengths = st.floats(0.1, 1e4)


def covariance(major: float, minor: float, azimuth: float) -> np.ndarray:
    turn = np.array(
        [[math.cos(azimuth), -math.sin(azimuth)], [math.sin(azimuth), math.cos(azimuth)]]
    )
    return turn @ np.diag([major**2, minor**2]) @ turn.T


@given(lengths, st.floats(0.01, 0.9), st.floats(-3.0, 3.0), st.floats(0.1, 0.99))
def test_axes_and_outline(major: float, ratio: float, azimuth: float, probability: float) -> None:
    """Every point of the outline has the squared Mahalanobis distance -2 ln(1 - p)."""
    spread = covariance(major, ratio * major, azimuth)
    ellipse = uncertainty_ellipse(spread, probability)
    assert ellipse is not None
    scale = math.sqrt(-2.0 * math.log(1.0 - probability))
    assert ellipse.semi_major == pytest.approx(scale * major)
    assert ellipse.semi_minor == pytest.approx(scale * ratio * major)
    assert math.sin(ellipse.azimuth - azimuth) == pytest.approx(0.0, abs=1e-5)
    offset = ellipse.outline(np.array([3.0, -4.0])) - [3.0, -4.0]
    squared = np.sum(offset * np.linalg.solve(spread, offset.T).T, axis=-1)
    np.testing.assert_allclose(squared, scale**2, rtol=1e-6)


def test_the_share_inside_is_the_probability() -> None:
    generator = np.random.default_rng(1)
    spread = covariance(100.0, 5.0, 0.5)
    samples = generator.multivariate_normal([0.0, 0.0], spread, 20_000)
    squared = np.sum(samples * np.linalg.solve(spread, samples.T).T, axis=-1)
    ellipse = uncertainty_ellipse(spread)
    assert ellipse is not None
    assert np.mean(squared < (ellipse.semi_major / 100.0) ** 2) == pytest.approx(0.95, abs=0.006)


@pytest.mark.parametrize(
    "improper", [np.full((2, 2), np.nan), np.zeros((4, 4)), np.diag([1.0, -1.0]), -np.eye(2)]
)
def test_a_covariance_that_is_none_has_no_ellipse(improper: np.ndarray) -> None:
    assert uncertainty_ellipse(improper) is None


def test_a_line_of_uncertainty_is_an_ellipse_without_width() -> None:
    ellipse = uncertainty_ellipse(np.array([[1.0, 1.0], [1.0, 1.0]]))
    assert ellipse is not None and ellipse.semi_minor == pytest.approx(0.0, abs=1e-6)
    assert ellipse.azimuth == pytest.approx(math.pi / 4)


def test_the_outline_begins_and_ends_on_the_major_axis() -> None:
    ellipse = UncertaintyEllipse(10.0, 3.0, math.pi / 6.0)
    outline = ellipse.outline(np.array([100.0, -50.0]), n_points=5)
    along = 10.0 * np.array([math.sqrt(0.75), 0.5])
    across = 3.0 * np.array([-0.5, math.sqrt(0.75)])
    expected = [along, across, -along, -across, along]
    np.testing.assert_allclose(outline - [100.0, -50.0], expected, atol=1e-12)
    assert ellipse.outline(np.zeros(2)).shape == (73, 2)


@pytest.mark.parametrize(("least", "proper"), [(-0.9e-9, True), (-1.1e-9, False)])
def test_a_billionth_below_zero_is_rounding(least: float, proper: bool) -> None:
    assert (uncertainty_ellipse(np.diag([4.0, 4.0 * least])) is not None) == proper
