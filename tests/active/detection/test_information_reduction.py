"""Protects the exact information reduction, where it can be integrated by hand.

Without clutter only the gate cuts: of the squared innovations of a plane, within g = 4 standard
deviations, q2 = P_D (1/2) int_0^g r^3 exp(-r^2 / 2) dr = P_D (1 - (1 + g^2 / 2) exp(-g^2 / 2)).
"""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.detection.detection_threshold import FalseAlarmLimits
from sonar_tracking.active.detection.information_reduction import (
    exact_information_reduction,
    information_reduction,
    optimal_false_alarm_probability,
)

WITHIN = 1.0 - 9.0 * np.exp(-8.0)


def test_without_clutter_the_probability_of_detection_is_left() -> None:
    detection = np.array([0.1, 0.5, 1.0])
    assert information_reduction(detection, 0.0) == pytest.approx(detection * WITHIN, rel=1e-6)


def test_a_little_clutter_takes_away_in_proportion_to_it() -> None:
    """One false contact in a gate of a target that is always seen leaves a fixed part."""
    q2 = information_reduction(1.0, np.array([0.0, 1e-3, 2e-3]))
    lost = q2[0] - q2[1:]
    assert lost[1] == pytest.approx(2.0 * lost[0], rel=1e-2)
    assert 0.0 < lost[0] < 1e-3


def test_clutter_only_takes_away_and_detection_only_gives() -> None:
    q2 = information_reduction(np.array([[0.5], [0.7], [0.9]]), np.array([0.0, 0.1, 1.0, 10.0]))
    assert q2.shape == (3, 4)
    assert np.all(np.diff(q2, axis=1) < 0.0)
    assert np.all(np.diff(q2, axis=0) > 0.0)
    assert q2.min() > 0.0


def test_threshold_and_cells_make_detection_and_clutter() -> None:
    """SNR 3: P_D is the fourth root of P_F; twenty cells hold twenty times P_F false alarms."""
    exact = exact_information_reduction(np.array([1e-4, 0.0625]), 20.0, 3.0)
    expected = information_reduction(np.array([0.1, 0.5]), np.array([2e-3, 1.25]))
    assert exact == pytest.approx(expected)


def test_the_optimum_is_one_and_is_clamped() -> None:
    wide = FalseAlarmLimits(1e-12, 1.0)
    best = optimal_false_alarm_probability(20.0, 10.0, wide)
    around = exact_information_reduction(best * np.array([0.9, 1.0, 1.1]), 20.0, 10.0)
    assert np.argmax(around) == 1
    assert optimal_false_alarm_probability(20.0, 10.0, FalseAlarmLimits(1e-8, 1e-4)) == 1e-4
    assert optimal_false_alarm_probability(20.0, 10.0, FalseAlarmLimits(0.2, 0.3)) == 0.2
