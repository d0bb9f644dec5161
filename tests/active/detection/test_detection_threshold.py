"""Protects: closed-form threshold, its clamps and refusals, decibels against linear ratios."""

import numpy as np
import pytest

from sonar_tracking.active.detection.detection_threshold import (
    FalseAlarmLimits,
    approximate_information_reduction,
    closed_form_false_alarm_probability,
    detection_probability,
    detection_threshold,
    linear_from_decibel,
)
from sonar_tracking.active.detection.information_reduction import (
    exact_information_reduction,
    information_reduction,
    optimal_false_alarm_probability,
)
from sonar_tracking.errors import ConfigurationError, InputError

WIDE = FalseAlarmLimits(1e-12, 1.0)


def test_threshold_and_detection_are_consistent() -> None:
    probability = np.array([1e-6, 1e-2, 0.3])
    threshold = detection_threshold(probability)
    assert np.exp(-threshold) == pytest.approx(probability, rel=1e-12)
    assert detection_probability(probability, 10.0) == pytest.approx(np.exp(-threshold / 11.0))


def test_decibels_are_converted_not_used() -> None:
    assert linear_from_decibel([0.0, 5.0, 10.0]) == pytest.approx([1.0, 10.0**0.5, 10.0])


@pytest.mark.parametrize("level_db", [3.0, 5.0, 10.0, 20.0])
@pytest.mark.parametrize("cells", [3.0, 16.6, 700.0])
def test_closed_form_maximises_the_approximation(level_db: float, cells: float) -> None:
    ratio = float(linear_from_decibel(level_db))
    best = float(closed_form_false_alarm_probability(cells, ratio, WIDE))
    if best == 1.0:
        assert level_db == 3.0
        return
    around = best * np.array([0.99, 1.0, 1.01])
    factors = approximate_information_reduction(around, cells, ratio)
    assert np.argmax(factors) == 1


def test_closed_form_is_the_formula() -> None:
    expected = (1.0 / (0.37 * 20.0 * 8.43)) ** (11.0 / 9.43)
    measured = float(closed_form_false_alarm_probability(20.0, 10.0, WIDE))
    assert measured == pytest.approx(expected, rel=1e-12)
    assert float(closed_form_false_alarm_probability(16.6, 10.0, WIDE)) == pytest.approx(
        1e-2, rel=0.01
    )


def test_result_is_clamped() -> None:
    limits = FalseAlarmLimits(1e-4, 0.2)
    assert float(closed_form_false_alarm_probability(0.1, 10.0, limits)) == pytest.approx(0.2)
    assert float(closed_form_false_alarm_probability(1e9, 10.0, limits)) == pytest.approx(1e-4)
    assert optimal_false_alarm_probability(1e-3, 10.0, limits) == pytest.approx(0.2)


@pytest.mark.parametrize("ratio", [0.0, 1.0, 1.57, 1.5700001])
def test_weak_targets_take_the_highest_probability(ratio: float) -> None:
    limits = FalseAlarmLimits(1e-8, 0.3)
    assert float(closed_form_false_alarm_probability(50.0, ratio, limits)) == pytest.approx(0.3)


@pytest.mark.parametrize("cells", [0.0, -1.0, np.nan, np.inf])
def test_an_empty_gate_is_refused(cells: float) -> None:
    with pytest.raises(InputError, match="resolution cells"):
        closed_form_false_alarm_probability(cells, 10.0, WIDE)


@pytest.mark.parametrize("ratio", [-3.0, np.nan])
def test_a_ratio_in_decibels_below_zero_is_refused(ratio: float) -> None:
    with pytest.raises(InputError, match="linear power ratio"):
        optimal_false_alarm_probability(10.0, ratio, WIDE)


@pytest.mark.parametrize(("low", "high"), [(0.0, 0.3), (0.4, 0.3), (0.1, 1.5)])
def test_limits_out_of_order_are_refused(low: float, high: float) -> None:
    with pytest.raises(ConfigurationError, match="limits"):
        FalseAlarmLimits(low, high)


def test_exact_factor_without_clutter_has_its_limit() -> None:
    assert float(information_reduction(1.0, 0.0)) == pytest.approx(1.0 - 9.0 * np.exp(-8.0))
    assert float(information_reduction(0.6, 0.0)) == pytest.approx(0.6 * 0.996981, abs=1e-6)


def test_exact_factor_is_the_expected_squared_innovation() -> None:
    """q2 S = E[nu nu'] of the combined innovation, by simulation of the filter's own model."""
    generator = np.random.default_rng(1)
    detection, clutter, gate = 0.8, 1.5, 4.0
    in_gate = 1.0 - np.exp(-0.5 * gate**2)
    rest = (2.0 / gate**2) * clutter * (1.0 - detection * in_gate) / detection
    n_trials = 40_000
    count = generator.poisson(clutter, n_trials)
    trial, total = np.repeat(np.arange(n_trials), count), count.sum()
    radius, angle = gate * np.sqrt(generator.random(total)), generator.random(total)
    false = radius[:, None] * np.stack(
        [np.cos(2 * np.pi * angle), np.sin(2 * np.pi * angle)], axis=1
    )
    target = generator.normal(size=(n_trials, 2))
    detected = generator.random(n_trials) < detection
    detected &= np.sum(target**2, axis=1) < gate**2
    points = np.vstack([target[detected], false])
    trial = np.append(np.flatnonzero(detected), trial)
    weights = np.exp(-0.5 * np.sum(points**2, axis=1))
    weighted = [
        np.bincount(trial, weights * along, minlength=n_trials) for along in (1.0, *points.T)
    ]
    combined = np.stack(weighted[1:]) / (rest + weighted[0])
    squares = 0.5 * np.sum(combined**2, axis=0)
    expected = float(information_reduction(detection, clutter))
    error = np.std(squares) / np.sqrt(len(squares))
    assert abs(np.mean(squares) - expected) < 4.0 * error


def test_exact_factor_agrees_with_the_reference() -> None:
    """Relative error of the approximation against the exact factor, independently computed."""
    for detection, clutter, error in ((0.6, 0.1, 0.059), (0.9, 3.0, 0.006), (0.5, 5.0, -0.077)):
        approximate = 0.997 * detection / (1.0 + 0.37 * detection**-1.57 * clutter)
        exact = float(information_reduction(detection, clutter))
        assert approximate / exact - 1.0 == pytest.approx(error, abs=1e-3)


@pytest.mark.parametrize(
    ("level_db", "cells", "expected"),
    [
        (5.0, 50.0, 6.168e-3),
        (10.0, 5.0, 3.740e-2),
        (10.0, 1000.0, 6.225e-5),
        (20.0, 20.0, 1.059e-3),
    ],
)
def test_exact_optimum_agrees_with_the_reference(
    level_db: float, cells: float, expected: float
) -> None:
    ratio = float(linear_from_decibel(level_db))
    assert optimal_false_alarm_probability(cells, ratio, WIDE) == pytest.approx(expected, rel=1e-3)


def test_exact_optimum_may_lie_at_the_bound() -> None:
    ratio = float(linear_from_decibel(5.0))
    assert optimal_false_alarm_probability(2.0, ratio, WIDE) == pytest.approx(1.0, abs=1e-6)


def test_exact_optimum_beats_the_closed_form() -> None:
    ratio = float(linear_from_decibel(15.0))
    for cells in (2.0, 100.0, 1000.0):
        closed = float(closed_form_false_alarm_probability(cells, ratio, WIDE))
        exact = optimal_false_alarm_probability(cells, ratio, WIDE)
        factors = exact_information_reduction([closed, exact], cells, ratio)
        assert factors[0] <= factors[1] + 1e-12


def test_approximate_factor_is_the_formula_and_near_the_exact_one() -> None:
    """0.997 P_D / (1 + 0.37 P_D^-1.57 n P_F)."""
    probability, cells, ratio = 0.01, 50.0, 9.0
    detection = 0.01**0.1
    expected = 0.997 * detection / (1.0 + 0.37 * detection**-1.57 * 0.5)
    computed = float(approximate_information_reduction(probability, cells, ratio))
    assert computed == pytest.approx(expected, rel=1e-12)
    exact = float(exact_information_reduction(probability, cells, ratio))
    assert computed == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize(("detection", "clutter"), [(0.5, 0.2), (0.9, 1.0), (0.8, 4.0)])
def test_exact_factor_agrees_with_the_sum_over_numbers_of_contacts(
    detection: float, clutter: float
) -> None:
    """The integral over t of the transform of the weights, summed otherwise."""
    in_gate = 1.0 - np.exp(-8.0)
    decay = 2.0 / 16.0 * clutter * (1.0 - detection * in_gate) / detection
    square = (np.arange(4000) + 0.5) * 16.0 / 4000.0  # of the radius in the gate
    variable = np.exp(np.linspace(-30.0, 13.0, 1500))
    transform = np.array([np.mean(np.exp(-t * np.exp(-0.5 * square))) for t in variable])
    # Of the target: r^2 times its density, each against its own share of the weights.
    target = 0.5 * (16.0 / 4000.0) * square * np.exp(-square)
    integrand = np.array([np.sum(target * np.exp(-t * np.exp(-0.5 * square))) for t in variable])
    total = integrand * np.exp(clutter * (transform - 1.0) - decay * variable) * variable
    step = 43.0 / 1499.0
    expected = 0.5 * detection * step * np.sum(total)
    assert float(information_reduction(detection, clutter)) == pytest.approx(expected, rel=2e-3)
