"""Protects the law of the amplitudes of false contacts, and what it says of targets."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from sonar_tracking.active.detection.clutter_amplitudes import (
    IN_NOISE,
    LARGEST_SHAPE,
    ExcessLaw,
    fit_excess_law,
)
from sonar_tracking.active.detection.gate_association import amplitude_likelihood_ratio

NOT_RAISED = np.zeros(1)
EVEN = (np.arange(1, 20_001) - 0.5) / 20_000.0


def pareto(law: ExcessLaw, excess: float) -> float:
    """Return the density of the law as textbooks write it."""
    if law.shape == 0.0:
        return float(np.exp(-excess / law.scale) / law.scale)
    base = 1.0 + law.shape * excess / law.scale
    return float(base ** (-1.0 - 1.0 / law.shape) / law.scale)


def quantiles(law: ExcessLaw) -> np.ndarray:
    """Return excesses at even steps of probability."""
    if law.shape == 0.0:
        return -law.scale * np.log1p(-EVEN)
    return law.scale / law.shape * ((1.0 - EVEN) ** -law.shape - 1.0)


@pytest.mark.parametrize("law", [IN_NOISE, ExcessLaw(5.0, 0.0), ExcessLaw(3.0, 0.3)])
def test_both_parameters_are_found(law: ExcessLaw) -> None:
    found = fit_excess_law(np.random.default_rng(1).permutation(quantiles(law)))
    assert found.scale == pytest.approx(law.scale, rel=0.01)
    assert found.shape == pytest.approx(law.shape, abs=0.01)


def test_what_no_such_law_gives_is_not_followed_out_of_bounds() -> None:
    assert fit_excess_law(np.full(40, 2.0)) == ExcessLaw(2.0, 0.0)
    assert fit_excess_law(np.zeros(40)).scale > 0.0
    assert fit_excess_law(np.linspace(1.0, 2.0, 40)).shape == 0.0
    wild = fit_excess_law(np.append(np.full(39, 1e-3), 1e6))
    assert wild.shape == LARGEST_SHAPE and wild.scale > 0.0


def test_in_noise_the_ratio_is_that_of_exponential_amplitudes() -> None:
    excess = np.linspace(0.0, 30.0, 7)
    expected = amplitude_likelihood_ratio(excess, 0.0, 10.0)
    assert np.array_equal(IN_NOISE.likelihood_ratio(excess, NOT_RAISED, 10.0), expected)
    near = ExcessLaw(1.0 + 1e-12, 0.0).likelihood_ratio(excess, NOT_RAISED, 10.0)
    assert near == pytest.approx(expected, rel=1e-9)
    shaped = ExcessLaw(1.0, 2e-6).likelihood_ratio(excess, NOT_RAISED, 10.0)
    assert shaped == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("raised", [0.0, 4.0])
@pytest.mark.parametrize("law", [ExcessLaw(2.0, 0.0), ExcessLaw(3.0, 0.3)])
def test_the_ratio_is_that_of_the_densities_above_the_threshold_in_force(
    law: ExcessLaw, raised: float
) -> None:
    passing = quad(lambda x: pareto(law, x), raised, np.inf)[0]
    for excess in (0.0, 1.0, 8.0):
        target = np.exp(-excess / 11.0) / 11.0
        clutter = pareto(law, raised + excess) / passing
        ratio = law.likelihood_ratio(np.array([excess]), np.array([raised]), 10.0)
        assert ratio[0] == pytest.approx(target / clutter, rel=1e-6)


@pytest.mark.parametrize("law", [ExcessLaw(3.0, 0.3), ExcessLaw(40.0, 0.0), ExcessLaw(40.0, 0.5)])
def test_a_stronger_contact_is_never_less_of_a_target(law: ExcessLaw) -> None:
    """The largest ratio of the first law lies at (1.3 * 11 - 3) / 0.3."""
    ratio = law.likelihood_ratio(np.linspace(0.0, 1e4, 2001), NOT_RAISED, 10.0)
    assert np.all(np.diff(ratio) >= -1e-12 * ratio[1:])
    if law.scale == 3.0:
        place = np.array([(1.3 * 11.0 - 3.0) / 0.3, 1e6])
        largest = law.likelihood_ratio(place, NOT_RAISED, 10.0)
        assert largest[0] == largest[1] == ratio[-1]
