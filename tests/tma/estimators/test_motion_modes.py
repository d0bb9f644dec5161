"""Protects the interaction of the modes of motion: probabilities, moments, irregular frames."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, mixture_moments
from sonar_tracking.tma.estimators.motion_modes import MODES, mix_modes, with_modes


def pair(weights: tuple[float, float]) -> HypothesisBank:
    """Return the two modes of one hypothesis, each a batch entry of its own."""
    return HypothesisBank(
        np.array([[[0.0, 0.0, 1.0, 0.0]], [[30.0, 0.0, 2.0, 1.0]]]),
        np.array([[np.diag([4.0, 4.0, 0.1, 0.1])], [np.diag([90.0, 90.0, 2.0, 2.0])]]),
        np.log(np.array(weights))[:, None],
        np.zeros((2, 0), dtype=bool),
    )


def whole(bank: HypothesisBank) -> HypothesisBank:
    """Return the modes as the components of a single run."""
    return HypothesisBank(
        bank.mean[:, 0], bank.covariance[:, 0], bank.log_weight[:, 0], np.zeros(0, dtype=bool)
    )


@pytest.mark.parametrize("elapsed", [0.0, 1.0, 30.0, 1e6])
def test_mixing_leaves_the_moments_of_the_hypothesis_as_they_are(elapsed: float) -> None:
    before = pair((0.9, 0.1))
    after = mix_modes(before, np.full(2, elapsed), 1000.0, 50.0)
    moments = zip(mixture_moments(whole(before)), mixture_moments(whole(after)), strict=True)
    for one, other in moments:
        assert other == pytest.approx(one)
    assert np.exp(after.log_weight).sum() == pytest.approx(1.0)


def test_without_time_nothing_changes() -> None:
    before = pair((0.9, 0.1))
    after = mix_modes(before, np.zeros(2), 1000.0, 50.0)
    assert after.mean == pytest.approx(before.mean)
    assert after.covariance == pytest.approx(before.covariance)
    assert after.log_weight == pytest.approx(before.log_weight)


def test_after_long_the_modes_are_as_likely_as_they_last() -> None:
    after = mix_modes(pair((0.9, 0.1)), np.full(2, 1e6), 300.0, 100.0)
    assert np.exp(after.log_weight[:, 0]) == pytest.approx([0.75, 0.25])
    assert after.mean[0] == pytest.approx(after.mean[1])
    started = with_modes(whole(pair((0.5, 0.5))), 300.0, 100.0)
    assert np.exp(started.log_weight) == pytest.approx([0.375, 0.125] * 2)
    assert started.mean[::MODES] == pytest.approx(started.mean[1::MODES])


def test_many_short_steps_are_one_long_one() -> None:
    weights = pair((0.95, 0.05))
    often = weights
    for _ in range(40):
        often = mix_modes(often, np.full(2, 0.5), 1000.0, 50.0)
    once = mix_modes(weights, np.full(2, 20.0), 1000.0, 50.0)
    assert often.log_weight == pytest.approx(once.log_weight)
