"""Protects the probabilities of detection that are found: Bayes' rule, priors, contradictions."""

import numpy as np
import pytest

from sonar_tracking.active.detection.detection_levels import (
    LEVELS,
    TYPICAL,
    UNTOLD,
    contradiction,
    forget,
    mean_probability,
    prior_weights,
    scene_weights,
    weigh,
)
from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE


def after(pings: list[bool], told: float = np.nan) -> np.ndarray:
    """Return the weights of a target detected without doubt, or not at all."""
    weights = prior_weights(told)[None]
    for detected in pings:
        mean = float(mean_probability(weights)[0])
        ratio = 1.0 + mean * PROBABILITY_IN_GATE * ((1e6 if detected else 0.0) - 1.0)
        weights = weigh(weights, mean_probability(weights), np.array([ratio]))
    return weights


def test_weights_are_those_of_a_binomial_law() -> None:
    pings = [True, False, True, True, False]
    weights = after(pings)
    likelihood = LEVELS**3 * (1.0 - PROBABILITY_IN_GATE * LEVELS) ** 2
    expected = UNTOLD * likelihood / np.sum(UNTOLD * likelihood)
    assert weights[0] == pytest.approx(expected, rel=1e-4)


def test_a_target_detected_every_other_time_is_found_out() -> None:
    for told in (np.nan, 0.9):
        found = float(mean_probability(after([True, False] * 30, told))[0])
        assert found == pytest.approx(0.5, abs=0.05)


def test_a_ping_that_says_nothing_changes_nothing() -> None:
    weights = after([True, False])
    assert weigh(weights, mean_probability(weights), np.ones(1)) == pytest.approx(weights)


def test_priors_are_probabilities_and_near_what_is_told() -> None:
    for told in (np.nan, 0.0, 0.5, 0.9, 1.0):
        assert np.sum(prior_weights(told)) == pytest.approx(1.0)
    assert float(mean_probability(prior_weights(np.nan))) == pytest.approx(TYPICAL)
    assert 0.75 < float(mean_probability(prior_weights(0.9))) < 0.9
    assert 0.4 < float(mean_probability(prior_weights(0.5))) < 0.6


def test_a_new_target_takes_after_the_confirmed_ones() -> None:
    weights = np.eye(6)[[2, 2, 5, 0]]
    confirmed = np.array([True, True, False, False])
    scene = scene_weights(weights, confirmed, np.nan)
    # The prior counts as much as two tracks.
    assert scene == pytest.approx((UNTOLD + np.eye(6)[2]) / 2.0)
    assert scene_weights(weights[:0], confirmed[:0], np.nan) == pytest.approx(UNTOLD)


def test_a_hundredth_is_forgotten_at_each_ping() -> None:
    weights = forget(np.eye(6)[[5]], UNTOLD)
    assert weights[0] == pytest.approx(0.99 * np.eye(6)[5] + 0.01 * UNTOLD)


def test_what_is_told_is_contradicted_only_by_tracks_that_are_sure() -> None:
    half = np.eye(6)[[2, 2, 2]]
    confirmed = np.ones(3, dtype=bool)
    (notice,) = contradiction(half, confirmed, 0.9)
    assert notice.culprit == "detection_probability"
    assert "50 %" in notice.text and "90 %" in notice.text
    assert contradiction(half, confirmed, 0.6) == ()
    assert contradiction(half, confirmed, np.nan) == ()
    assert contradiction(half, ~confirmed, 0.9) == ()
    unsure = np.tile(UNTOLD, (3, 1))
    assert contradiction(unsure, confirmed, 0.9) == ()
