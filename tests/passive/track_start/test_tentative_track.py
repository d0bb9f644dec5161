"""Protects the line through joined bearings and the probability that a source made them."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.track_start.tentative_track import TentativeTrack

SECOND = 1_000_000_000


def test_probability_is_five_to_one_for_each_bearing_and_one_to_two_for_each_miss() -> None:
    """At the first bearing it is one to four."""
    track = TentativeTrack(1, (0,), (0.1,), (1e-4,))
    assert track.existence_probability == pytest.approx(0.2)
    probabilities = []
    for number in range(1, 4):
        track = track.add(number * SECOND, 0.1, 1e-4)
        probabilities.append(track.existence_probability)
    assert probabilities == pytest.approx([1.25 / 2.25, 6.25 / 7.25, 31.25 / 32.25])
    missed = TentativeTrack(1, (0, SECOND), (0.1, 0.1), (1e-4, 1e-4), misses=1)
    assert missed.existence_probability == pytest.approx(0.625 / 1.625)
    assert missed.add(2 * SECOND, 0.1, 1e-4).misses == 0


def test_the_line_is_that_of_weighted_least_squares() -> None:
    times, angles = np.array([0.0, 0.5, 1.5, 2.0]), np.array([0.10, 0.12, 0.11, 0.16])
    variances = np.array([1e-4, 4e-4, 1e-4, 9e-4])
    stamps = tuple(round(time * SECOND) for time in times)
    track = TentativeTrack(1, stamps, tuple(angles), tuple(variances))
    mean, covariance = track.line(3 * SECOND)
    fit, spread = np.polyfit(times - 3.0, angles, 1, w=variances**-0.5, cov="unscaled")
    assert mean == pytest.approx(fit[::-1])
    assert covariance == pytest.approx(spread[::-1, ::-1])
