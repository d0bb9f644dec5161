"""Protects what a bearing track alone makes likely, which trials are weighed against."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.fusion.lone_bearings import heard, predicted_bearings, unheard


def sided(azimuth_deg: float, other_deg: float) -> Bearings:
    """Return one bearing of a line array, with a deviation of half a degree."""
    near, other, variance = np.radians([azimuth_deg]), np.radians([other_deg]), 0.5**2
    noise = np.radians(1.0) ** 2 * np.array([variance])
    return Bearings(near, noise, np.zeros(2), array=0, other_side=other)


def test_sides_change_nothing_of_how_a_source_at_the_axis_goes_on() -> None:
    """Which of both sides is told first is by chance there."""
    one = other = unheard(1)
    for measured in (0.3, 0.1, 0.2, 0.3, 0.1):
        one, first = heard(predicted_bearings(one, 2.0), sided(measured, -measured))
        other, second = heard(predicted_bearings(other, 2.0), sided(-measured, measured))
        assert first == pytest.approx(second)
    assert np.abs(one.mean) == pytest.approx(np.abs(other.mean))


def test_a_bearing_of_the_axis_is_twice_as_likely_as_one_of_a_single_side() -> None:
    track, _ = heard(unheard(1), sided(0.0, 0.0))
    track = predicted_bearings(track, 2.0)
    alone = Bearings(np.zeros(1), np.radians([0.5]) ** 2, np.zeros(2), array=0)
    _, both = heard(track, sided(0.0, 0.0))
    _, one = heard(track, alone)
    assert both - one == pytest.approx(np.log(2.0))


def test_far_from_the_axis_the_other_side_counts_for_nothing() -> None:
    track, _ = heard(unheard(1), sided(60.0, -60.0))
    track, density = heard(predicted_bearings(track, 2.0), sided(-60.2, 60.2))
    assert np.degrees(track.mean[0, 0]) == pytest.approx(60.1, abs=0.2)
    assert density[0] > 0.0
