"""Protects the interaction of the modes of motion: probabilities, moments, irregular frames."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators import motion_modes
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.mixture_moments import mixture_moments
from sonar_tracking.tma.estimators.motion_modes import (
    MIXED,
    MODES,
    WANDERING,
    WEAVING,
    mix_modes,
    predict_modes,
    with_modes,
)
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration

WEAVES, WANDERS = 0.3, 0.25
"""Probabilities; that it wanders, of a target that does not weave."""

EACH = WEAVES / 3.0
"""Of each period."""

LASTING = slice(MIXED, None)
"""What does not interact."""


def targets(interval: float, duration: float) -> RangeBankConfiguration:
    return RangeBankConfiguration(
        manoeuvre_interval=interval,
        manoeuvre_duration=duration,
        weave_probability=WEAVES,
        wander_probability=WANDERS,
    )


def modes(*weights: float) -> HypothesisBank:
    """Return the modes of one hypothesis, each a batch entry of its own, a deviation after them."""
    mean = np.zeros((MODES, 1, 8))
    mean[:, 0, :4] = [
        [0.0, 0.0, 1.0, 0.0],
        [30.0, 0.0, 2.0, 1.0],
        [20.0, -5.0, 1.0, 2.0],
        [-10.0, 5.0, 1.0, 1.0],
        [-20.0, 5.0, 1.0, 1.0],
        [-30.0, 5.0, 1.0, 1.0],
    ]
    covariance = np.zeros((MODES, 1, 8, 8))
    spreads = [4.0, 4.0, 0.1, 0.1], [90.0, 90.0, 2.0, 2.0], [9.0, 9.0, 1.0, 1.0], *[[8.0] * 4] * 3
    for mode, spread in enumerate(spreads):
        covariance[mode, 0, :4, :4] = np.diag(spread)
    covariance[WEAVING:, 0, 4:, 4:] = np.diag([1.0, 1.0, 0.1, 0.1])
    return HypothesisBank(
        mean, covariance, np.log(np.array(weights))[:, None], np.zeros((MODES, 0), dtype=bool)
    )


def whole(bank: HypothesisBank, part: slice = slice(None)) -> HypothesisBank:
    """Return some modes as the components of a single run."""
    weight = bank.log_weight[part, 0] - np.logaddexp.reduce(bank.log_weight[part, 0])
    return HypothesisBank(
        bank.mean[part, 0], bank.covariance[part, 0], weight, np.zeros(0, dtype=bool)
    )


@pytest.mark.parametrize("elapsed", [0.0, 1.0, 30.0, 1e6])
def test_mixing_leaves_the_moments_of_what_turns_as_they_are(elapsed: float) -> None:
    before = modes(0.5, 0.1, 0.1, 0.1, 0.1, 0.1)
    after = mix_modes(before, np.full(MODES, elapsed), targets(1000.0, 50.0))
    mixed = slice(MIXED)
    moments = zip(
        mixture_moments(whole(before, mixed)), mixture_moments(whole(after, mixed)), strict=True
    )
    for one, other in moments:
        assert other == pytest.approx(one)
    assert np.exp(after.log_weight).sum() == pytest.approx(1.0)
    assert after.mean[LASTING] == pytest.approx(before.mean[LASTING])
    assert after.covariance[LASTING] == pytest.approx(before.covariance[LASTING])


def test_without_time_nothing_changes() -> None:
    before = modes(0.5, 0.1, 0.1, 0.1, 0.1, 0.1)
    after = predict_modes(before, np.zeros(MODES), targets(1000.0, 50.0))
    assert after.mean == pytest.approx(before.mean)
    assert after.covariance == pytest.approx(before.covariance)
    assert after.log_weight == pytest.approx(before.log_weight)


def test_after_long_the_modes_are_as_likely_as_they_last() -> None:
    after = mix_modes(
        modes(0.5, 0.1, 0.1, 0.1, 0.1, 0.1), np.full(MODES, 1e6), targets(300.0, 100.0)
    )
    assert np.exp(after.log_weight[:, 0]) == pytest.approx([0.39375, 0.13125, 0.175, *[EACH] * 3])
    assert after.mean[0] == pytest.approx(after.mean[1])
    single = HypothesisBank(
        np.zeros((2, 4)), np.ones((2, 4, 4)), np.log([0.5, 0.5]), np.zeros(0, bool)
    )
    started = with_modes(single, targets(300.0, 100.0))
    assert np.exp(started.log_weight) == pytest.approx(
        [0.196875, 0.065625, 0.0875, *[EACH / 2.0] * 3] * 2
    )
    assert started.mean[::MODES] == pytest.approx(started.mean[1::MODES])


def test_many_short_steps_are_one_long_one() -> None:
    """But for targets that turn before they begin to weave, within the same step."""
    before, configuration = modes(0.45, 0.05, 0.1, 0.1, 0.1, 0.2), targets(1000.0, 50.0)
    often = before
    for _ in range(40):
        often = mix_modes(often, np.full(MODES, 0.5), configuration)
    once = mix_modes(before, np.full(MODES, 20.0), configuration)
    assert often.log_weight == pytest.approx(once.log_weight)


@pytest.mark.parametrize("mode", [WANDERING, WEAVING, WEAVING + 2])
def test_what_speaks_for_wandering_or_weaving_adds_up(mode: int) -> None:
    """A little every second, ten times less than what a turn would have to have for itself."""
    bank, configuration = modes(0.39, 0.01, 0.15, 0.15, 0.15, 0.15), targets(30_000.0, 100.0)
    spoken = 0.05 * (np.arange(MODES) == mode)
    for _ in range(100):
        bank = mix_modes(bank, np.ones(MODES), configuration)
        weight = bank.log_weight + spoken[:, None]
        bank = replace(bank, log_weight=weight - np.logaddexp.reduce(weight, axis=0))
    assert np.exp(bank.log_weight[mode, 0]) > 0.95


@pytest.mark.skipif(motion_modes.COMPILED is None, reason="no compiler was there")
@pytest.mark.parametrize("elapsed", [0.0, 0.05, 1.0, 300.0])
def test_compiled_modes_give_the_bits_of_numpy(
    elapsed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    generator = np.random.default_rng(5)
    n_hypotheses, size, lines = 7, 10, 2
    root = generator.standard_normal((n_hypotheses * MODES, 1, size, size))
    before = HypothesisBank(
        generator.standard_normal((n_hypotheses * MODES, 1, size)),
        root @ np.swapaxes(root, -1, -2),
        np.log(generator.dirichlet(np.ones(n_hypotheses * MODES)))[:, None],
        np.ones((n_hypotheses * MODES, lines), dtype=bool),
    )
    times = elapsed * np.repeat(generator.uniform(0.5, 1.5, n_hypotheses), MODES)
    compiled = predict_modes(before, times, targets(1000.0, 50.0))
    monkeypatch.setattr(motion_modes, "COMPILED", None)
    plain = predict_modes(before, times, targets(1000.0, 50.0))
    for name in ("mean", "covariance", "log_weight"):
        assert np.array_equal(getattr(compiled, name), getattr(plain, name)), name
