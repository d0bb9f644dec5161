"""Protects Chan's sum of lines and when the published filters restart.

A target straight ahead along x that does not move: with every azimuth its speed across is known
better, from the 20 / sqrt(3) m/s of the prior on; after a restart it is as unknown as before.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from sonar_tracking.tma.baselines.baseline_estimators import (
    restarted_stacked_lines,
    stacked_lines,
    summed_lines,
)
from sonar_tracking.tma.baselines.chan_summed_lines import sum_of_lines
from sonar_tracking.tma.estimators.estimator import Estimator
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration

NAN = np.nan
CONFIGURATION = RangeBankConfiguration(maximum_range=6000.0, maximum_speed=20.0)
PRIOR = 20.0**2 / 3.0
RESTARTED = PRIOR - (10.0 * PRIOR) ** 2 / (100.0 * PRIOR + 2.0 * 900.0)
"""Ten seconds after the prior, by an azimuth of 0.01 rad at 3 km: as its own was, (30 m)^2."""


def frame(second: int, *frequencies: float) -> TmaMeasurement:
    return TmaMeasurement(
        stamp=second * 1_000_000_000,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.zeros(1),
        azimuth_variance=np.array(1e-4),
        frequency=np.array(frequencies),
        frequency_deviation=np.array([0.3, 0.4, 0.5])[: len(frequencies)],
    )


def test_the_prior_of_a_single_filter() -> None:
    """Range uniform from 0 to 6 km, speeds from -20 to 20 m/s."""
    bank = SingleFilterConfiguration(6000.0, 20.0).start(frame(1))
    assert bank.mean[0] == pytest.approx([3000.0, 0.0, 0.0, 0.0], abs=1e-9)
    across = 3000.0**2 * 1e-4
    expected = [6000.0**2 / 12.0, across, PRIOR, PRIOR]
    assert np.diagonal(bank.covariance[0]) == pytest.approx(expected, rel=1e-9)


def test_the_sum_of_the_lines_that_are_heard() -> None:
    summed = sum_of_lines(frame(1, 100.0, NAN, 300.0))
    assert summed.frequency.tolist() == [400.0]
    assert summed.frequency_deviation.tolist() == pytest.approx([math.hypot(0.3, 0.5)])
    all_three = sum_of_lines(frame(1, 100.0, 200.0, 300.0))
    assert all_three.frequency.tolist() == [600.0]
    assert all_three.frequency_deviation.tolist() == pytest.approx([math.sqrt(0.5)])
    assert np.isnan(sum_of_lines(frame(1, NAN, NAN, NAN)).frequency).tolist() == [True]
    assert sum_of_lines(frame(1)).frequency.shape == (1,)


def speed_variances(estimator: Estimator, *lines: tuple[float, ...]) -> list[float]:
    """Return the variance of the speed across after twenty frames of each set of lines."""
    found = []
    for number, heard in enumerate(lines):
        for second in range(20 * number, 20 * number + 20):
            estimate = estimator.update(frame(10 * (second + 1), *heard))
            if second == 20 * number:
                first = float(estimate.covariance[3, 3])
        found += [first, float(estimate.covariance[3, 3])]
    return found


TWO, OTHER_TWO, ONE = (100.0, 200.0, NAN), (100.0, NAN, 300.0), (100.0, NAN, NAN)


def test_summed_lines_restart_at_any_change() -> None:
    one, known, gone, again, other, _ = speed_variances(
        summed_lines(CONFIGURATION), TWO, ONE, OTHER_TWO
    )
    assert one == pytest.approx(PRIOR, rel=1e-3)
    assert (gone, other) == pytest.approx((RESTARTED, RESTARTED), rel=1e-3)
    assert known < 0.05 * PRIOR and again < 0.05 * PRIOR


def test_stacked_lines_restart_when_a_line_appears_or_never() -> None:
    one, known, gone, _, other, _ = speed_variances(
        restarted_stacked_lines(CONFIGURATION), TWO, ONE, OTHER_TWO
    )
    assert one == pytest.approx(PRIOR, rel=1e-3)
    assert known < 0.05 * PRIOR and gone < 0.05 * PRIOR
    assert other == pytest.approx(RESTARTED, rel=1e-3)
    never = speed_variances(stacked_lines(CONFIGURATION), TWO, ONE, OTHER_TWO)
    assert max(never[1:]) < 0.05 * PRIOR
