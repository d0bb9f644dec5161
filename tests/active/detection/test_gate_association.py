"""Protects: amplitude ranks in their stable form, and the likelihood ratios of a gate."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest

from sonar_tracking.active.detection.amplitude_order_statistics import (
    rank_probabilities,
    rank_probabilities_of,
)
from sonar_tracking.active.detection.gate_association import (
    PROBABILITY_IN_GATE,
    GateModel,
    amplitude_likelihood_ratio,
    associate_by_distance,
    associate_by_rank,
)


def rank_by_alternating_sum(rank: int, count: int, ratio: int) -> float:
    """Integrate C(m-1, l-1) s u^(l-2+s) (1-u)^(m-l) exactly, by expanding the last power."""
    shape = Fraction(1, 1 + ratio)
    total = Fraction(0)
    for power in range(count - rank + 1):
        total += Fraction((-1) ** power * comb(count - rank, power)) / (rank - 1 + shape + power)
    return float(comb(count - 1, rank - 1) * shape * total)


@pytest.mark.parametrize("count", [1, 2, 5, 12, 80])
def test_ranks_agree_with_exact_rational_arithmetic(count: int) -> None:
    expected = [rank_by_alternating_sum(rank, count, 10) for rank in range(1, count + 1)]
    assert rank_probabilities(count, 10.0) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("count", [1, 7, 40, 100, 1000])
@pytest.mark.parametrize("ratio", [0.5, 5.0, 10.0, 100.0])
def test_ranks_sum_to_one_and_end_in_closed_form(count: int, ratio: float) -> None:
    probabilities = rank_probabilities(count, ratio)
    assert np.sum(probabilities) == pytest.approx(1.0, abs=1e-10)
    assert probabilities[-1] == pytest.approx(1.0 / (count + (count - 1) * ratio), rel=1e-9)


def test_strongest_of_eighty() -> None:
    assert rank_probabilities(80, 10.0)[0] == pytest.approx(0.64159, abs=5e-6)


def test_ranks_belong_to_the_amplitudes() -> None:
    probabilities = rank_probabilities(3, 5.0)
    assert rank_probabilities_of(np.array([2.0, 9.0, 4.0]), 5.0) == pytest.approx(
        [probabilities[2], probabilities[0], probabilities[1]]
    )


def test_without_amplitudes_all_ranks_are_alike() -> None:
    assert rank_probabilities_of(np.array([np.nan, np.nan]), 5.0) == pytest.approx([0.5, 0.5])


def test_an_empty_gate_speaks_against_a_target() -> None:
    model = GateModel(1e4, 1e-6, 0.9)
    for outcome in (
        associate_by_distance(np.zeros(0), model),
        associate_by_rank(np.zeros(0), np.zeros(0), model, 10.0),
    ):
        assert outcome.likelihood_ratio == pytest.approx(1.0 - 0.9 * PROBABILITY_IN_GATE)
        assert len(outcome.probabilities) == 0


def test_one_contact_gives_the_same_by_rank_and_by_distance() -> None:
    """With a single contact its rank carries no information."""
    model, density = GateModel(1e4, 2e-4, 0.8), np.array([3e-4])
    by_rank = associate_by_rank(density, np.array([7.0]), model, 10.0)
    by_distance = associate_by_distance(density, model)
    assert by_rank.probabilities == pytest.approx(by_distance.probabilities, rel=1e-12)


@pytest.mark.slow
def test_likelihood_ratio_has_mean_one_without_target() -> None:
    """A filter that hears only clutter must not come to believe in a target."""
    generator = np.random.default_rng(2)
    model = GateModel(16.0 * np.pi, 0.8 / (16.0 * np.pi), 0.7)
    ratios = []
    for _ in range(20_000):
        count = generator.poisson(0.8)
        square = 16.0 * generator.random(count)
        ratios.append(
            associate_by_distance(np.exp(-0.5 * square) / (2 * np.pi), model).likelihood_ratio
        )
    assert abs(np.mean(ratios) - 1.0) < 4.0 * np.std(ratios) / np.sqrt(len(ratios))


@pytest.mark.parametrize(("clutter", "expected", "margin"), [(0.1, 1.0, 0.08), (5.0, 1.22, 0.08)])
def test_selection_favours_targets_in_dense_gates_only(
    clutter: float, expected: float, margin: float
) -> None:
    """Mean likelihood ratio of HPDA without a target: a property of the published rule."""
    generator = np.random.default_rng(3)
    model = GateModel(16.0 * np.pi, clutter / (16.0 * np.pi), 0.9)
    ratios = []
    for _ in range(6000):
        count = generator.poisson(clutter)
        density = np.exp(-0.5 * 16.0 * generator.random(count)) / (2 * np.pi)
        amplitudes = generator.exponential(size=count)
        ratios.append(associate_by_rank(density, amplitudes, model, 10.0).likelihood_ratio)
    assert np.mean(ratios) == pytest.approx(expected, abs=margin)


def test_rank_selects_one_contact_by_strength_and_distance() -> None:
    model = GateModel(1e4, 1e-4, 0.9)
    densities = np.array([2e-4, 2e-4, 1e-7])
    outcome = associate_by_rank(densities, np.array([3.0, 30.0, 40.0]), model, 10.0)
    assert np.count_nonzero(outcome.probabilities) == 1
    assert np.argmax(outcome.probabilities) == 1
    assert 0.0 < outcome.probabilities[1] < 1.0


def test_amplitude_ratio_integrates_to_one_under_noise() -> None:
    amplitude = np.linspace(2.0, 400.0, 400_001)
    noise = np.exp(-(amplitude - 2.0))
    ratio = amplitude_likelihood_ratio(amplitude, 2.0, 5.0)
    assert float(np.sum(noise * ratio) * (amplitude[1] - amplitude[0])) == pytest.approx(
        1.0, abs=1e-3
    )


def test_a_gate_of_four_deviations_holds_its_share_of_a_plane_gaussian() -> None:
    assert pytest.approx(1.0 - np.exp(-8.0), rel=1e-12) == PROBABILITY_IN_GATE


def test_distance_shares_by_density_and_amplitude_over_the_clutter() -> None:
    model = GateModel(1e4, 1e-4, 0.8)
    densities, ratios = np.array([2e-4, 1e-4]), np.array([0.5, 3.0])
    outcome = associate_by_distance(densities, model, ratios)
    weights = 0.8 * np.array([1.0, 3.0])
    total = 1.0 - 0.8 * PROBABILITY_IN_GATE + 3.2
    assert outcome.probabilities == pytest.approx(weights / total)
    assert outcome.likelihood_ratio == pytest.approx(total)


def test_rank_against_its_published_formula() -> None:
    """Target of rank and clutter of rank, in a gate of two contacts."""
    model = GateModel(5e3, 3e-4, 0.9)
    densities, amplitudes = np.array([3e-4, 1e-4]), np.array([4.0, 9.0])
    outcome = associate_by_rank(densities, amplitudes, model, 10.0)
    in_gate = 0.9 * PROBABILITY_IN_GATE
    poisson = 2.0 / 1.5
    ranks = rank_probabilities(2, 10.0)[[1, 0]]
    target = in_gate * poisson * ranks
    clutter = in_gate * poisson + (1.0 - in_gate) - target
    from_target, from_clutter = densities / PROBABILITY_IN_GATE * target, clutter / 5e3
    expected = from_target / (from_target + from_clutter)
    best = int(np.argmax(expected))
    assert outcome.probabilities[best] == pytest.approx(expected[best])
    assert outcome.probabilities[1 - best] == 0.0
    assert outcome.likelihood_ratio == pytest.approx(clutter[best] + 5e3 * from_target[best])


def test_the_amplitude_ratio_begins_at_the_threshold_and_stays_finite() -> None:
    ratios = amplitude_likelihood_ratio(np.array([1.0, 2.0, 2.0 + 1.1, 1e9]), 2.0, 10.0)
    assert ratios[0] == ratios[1] == pytest.approx(1.0 / 11.0)
    assert ratios[2] == pytest.approx(np.exp(1.0) / 11.0)
    assert np.isfinite(ratios[3])
    assert ratios[3] == pytest.approx(np.exp(300.0) / 11.0)
