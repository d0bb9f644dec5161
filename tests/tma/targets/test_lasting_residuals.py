"""Protects what lasting errors are taken to be when stations go on to disagree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.tma.targets.lasting_residuals import (
    DirectionResidual,
    LastingResiduals,
    direction_residuals,
)
from sonar_tracking.tma.targets.systematic_errors import SystematicErrors
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution

SECOND = 1_000_000_000
LASTING = 0.01
ERRORS = SystematicErrors(LASTING)


def after(values: list[list[float]], white: float = 1e-6) -> LastingResiduals:
    """Return what is kept of residuals, rad, of several directions, one a second."""
    kept = LastingResiduals()
    for second, row in enumerate(values):
        for number, value in enumerate(row):
            one = DirectionResidual(value, white, 0.0, LASTING)
            kept.add(str(number), "azimuth", one, (second + 1) * SECOND)
    return kept


def test_directions_that_agree_leave_the_error_as_told() -> None:
    assert after([[0.0, 0.0, 0.0, 0.0]] * 100).factor(2, 0) == 1.0
    generator = np.random.default_rng(1)
    noise = (LASTING * generator.standard_normal((300, 4))).tolist()
    assert after(noise, LASTING**2).factor(2, 0) < 1.2


def test_a_disagreement_of_three_deviations_is_found_within_a_minute() -> None:
    """Four residuals of three deviations, two of them free: (1 + 36) / (1 + 2)."""
    found = after([[3.0 * LASTING, -3.0 * LASTING, 3.0 * LASTING, -3.0 * LASTING]] * 60)
    assert found.factor(2, 0) == pytest.approx(37.0 / 3.0, rel=0.01)
    assert found.factor(2, 61 * SECOND) == 1.0


def test_an_outlier_among_good_bearings_counts_little() -> None:
    rows = [[0.0, 0.0]] * 60 + [[2.0, 0.0]]
    assert after(rows).factor(2, 0) < 1.1


def solution(height: float | None) -> TargetSolution:
    """Return a solution 1000 m east, and 500 m up if that is estimated."""
    covariance = np.diag([400.0, 100.0, 1.0, 1.0])
    spatial = None
    if height is not None:
        mean = np.array([1000.0, 0.0, 0.0, 0.0, height, 0.0])
        wider = np.diag([400.0, 100.0, 1.0, 1.0, 100.0, 1.0])
        wider[0, 4] = wider[4, 0] = 200.0
        spatial = KalmanState(mean, wider)
    return TargetSolution(
        *(SECOND, "single", 1.0, np.array([1000.0, 0.0, 0.0, 0.0]), covariance, 1.0, True, ()),
        *(np.empty(0), np.empty(0), False, spatial),
    )


def test_residuals_are_angles_between_lines_of_sight() -> None:
    """With a height that is known and with one that is estimated: along the line of sight alike."""
    told = TargetObservation(
        *(SECOND, "bow", (0.0, 0.0), (0.0, 0.0), (0.02,), 1e-4),
        elevation=float(np.arctan(0.5)) + 0.01,
        elevation_variance=4e-4,
        height=500.0,
    )
    found = direction_residuals(told, solution(None), ERRORS)
    flat = 1.0 / np.sqrt(1.25)
    assert found["azimuth"].value == pytest.approx(0.02 * flat)
    assert found["azimuth"].white == pytest.approx(1e-4 * flat**2)
    assert found["azimuth"].solution == pytest.approx(100.0 / 1.25e6)
    assert found["elevation"].value == pytest.approx(0.01)
    assert found["elevation"].solution == pytest.approx(400.0 * (500.0 / 1.25e6) ** 2)
    estimated = direction_residuals(told, solution(500.0), ERRORS)
    assert estimated["elevation"].value == pytest.approx(0.01)
    # 20 m along and 10 m up, fully correlated: the line of sight, along which nothing changes.
    assert estimated["elevation"].solution == pytest.approx(0.0, abs=1e-12)


def test_one_error_of_a_cone_angle_has_one_sign_on_both_sides_of_the_array() -> None:
    """Array along x, a target in the image: which side counts as the more probable is rounding."""
    place, error = np.array([800.0, 600.0, 0.0, 0.0]), 0.02
    azimuth = float(np.arctan2(600.0, 800.0)) + error
    told = TargetObservation(SECOND, "line", (0.0, 0.0), (0.0, 0.0), (azimuth, -azimuth), 1e-4)
    left = replace(solution(None), side="left", mean=place)
    right = replace(solution(None), side="right", mean=place * [1.0, -1.0, 1.0, 1.0])
    for one in (left, right):
        found = direction_residuals(told, one, ERRORS)["azimuth"]
        assert found.value == pytest.approx(error)
