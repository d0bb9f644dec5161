"""Protects how a height that is not known joins the state: answers derived by hand, one a step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    predict_bank,
    start_bank,
)
from sonar_tracking.tma.estimators.measurement_model import linearise
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement
from sonar_tracking.tma.estimators.vertical_motion import seed_height, with_vertical
from sonar_tracking.tma.estimators.vertical_prediction import (
    VERTICAL_SPEED,
    VERTICAL_TIME,
    predict_vertical,
)

ELEVATION, DEVIATION, STATION = float(np.radians(30.0)), 0.01, -1000.0
PRIOR = 1e6
"""Standard deviation of a height of which nothing is known, m."""


def measurement(elevation: float = ELEVATION, deviation: float = PRIOR) -> TmaMeasurement:
    """Return an azimuth due east with an elevation, from the bottom at the origin."""
    return TmaMeasurement(
        stamp=0,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.zeros(1),
        azimuth_variance=np.array(1e-4),
        elevation=np.array(elevation),
        elevation_variance=np.array(DEVIATION**2),
        height_deviation=deviation,
        sensor_z=STATION,
    )


def bank(edges: tuple[float, ...] = (900.0, 1100.0)) -> HypothesisBank:
    """Return range hypotheses, each a batch entry of its own as in the estimator."""
    begun = with_vertical(start_bank(measurement(), np.array(edges), 5.0))
    return HypothesisBank(
        begun.mean[:, None],
        begun.covariance[:, None],
        begun.log_weight[:, None],
        np.zeros((len(begun.mean), 0), dtype=bool),
    )


def test_the_first_elevation_makes_the_height_with_the_error_of_the_range() -> None:
    begun = bank()
    seeded, new = seed_height(begun, measurement())
    slope = np.tan(ELEVATION)
    along = 200.0**2 / 12.0
    spread = slope**2 * along + (1000.0 * (1.0 + slope**2) * DEVIATION) ** 2
    assert new.tolist() == [True]
    assert seeded.mean[0, 0, KINEMATIC] == pytest.approx(STATION + 1000.0 * slope, rel=1e-6)
    covariance = seeded.covariance[0, 0]
    assert covariance[KINEMATIC, KINEMATIC] == pytest.approx(spread, rel=1e-6)
    assert covariance[KINEMATIC, 0] == pytest.approx(slope * along, rel=1e-6)
    assert covariance[0, 0] == pytest.approx(along, rel=1e-6)


def test_the_second_elevation_says_nothing_of_the_range() -> None:
    """Range and height move together along the line of sight."""
    seeded, _ = seed_height(bank(), measurement())
    rows = linearise(seeded.mean, measurement(), seeded.known, np.zeros(1))
    along = np.zeros(seeded.mean.shape[-1])
    along[0], along[KINEMATIC] = 1.0, np.tan(ELEVATION)
    assert rows.derivative[0, 0, 1] @ along == pytest.approx(0.0, abs=1e-12)
    assert rows.innovation[0, 0, 1] == pytest.approx(0.0, abs=1e-6)
    again, new = seed_height(seeded, measurement())
    assert not new.any() and again is seeded


def test_a_range_that_puts_the_target_too_high_loses_weight_and_a_level_one_does_not() -> None:
    edges = (900.0, 1100.0, 9000.0, 11000.0)
    steep, _ = seed_height(bank(edges), measurement(deviation=500.0))
    level, _ = seed_height(bank(edges), measurement(elevation=0.0, deviation=500.0))
    lost = steep.log_weight[2, 0] - steep.log_weight[0, 0]
    assert lost < -4.0
    assert level.log_weight[2, 0] - level.log_weight[0, 0] == pytest.approx(0.0, abs=0.1)


def test_of_nothing_known_beforehand_nothing_is_lost() -> None:
    """So a target with elevations is compared fairly with one without."""
    seeded, _ = seed_height(bank(), measurement())
    np.testing.assert_allclose(seeded.log_weight, bank().log_weight, atol=1e-4)


def test_a_height_known_beforehand_gives_the_range() -> None:
    """Near the surface, 1000 m above: r = 1000 m / tan(e), as if the height had been told."""
    told = replace(measurement(deviation=1.0), height=1000.0)
    seeded, _ = seed_height(bank((1000.0, 2600.0)), told)
    assert seeded.mean[0, 0, 0] == pytest.approx(1000.0 / np.tan(ELEVATION), abs=3.0)
    deviation = 1.0 / np.sin(ELEVATION) ** 2 * 1000.0 * DEVIATION
    assert np.sqrt(seeded.covariance[0, 0, 0, 0]) == pytest.approx(deviation, rel=0.1)


def test_a_prediction_is_the_same_in_one_step_and_in_two() -> None:
    generator = np.random.default_rng(1)
    root = generator.standard_normal((6, 6))
    mean, covariance = generator.standard_normal(6), root @ root.T
    once = predict_vertical(mean, covariance, np.array(50.0))
    twice = predict_vertical(*predict_vertical(mean, covariance, np.array(20.0)), np.array(30.0))
    for one, other in zip(once, twice, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9)


def test_the_vertical_speed_settles_and_the_height_goes_on_like_a_random_walk() -> None:
    mean, covariance = np.array([0.0, 3.0]), np.diag([1.0, 0.01])
    mean, covariance = predict_vertical(mean, covariance, np.array(100.0 * VERTICAL_TIME))
    assert mean == pytest.approx([3.0 * VERTICAL_TIME, 0.0], abs=1e-6)
    assert covariance[1, 1] == pytest.approx(VERTICAL_SPEED**2)
    walked = 2.0 * VERTICAL_SPEED**2 * VERTICAL_TIME * 100.0 * VERTICAL_TIME
    assert covariance[0, 0] == pytest.approx(walked, rel=0.02)


def test_a_height_of_which_nothing_is_known_stays_so() -> None:
    moved = predict_bank(bank(), 10.0, np.array(0.1))
    assert not moved.mean[..., KINEMATIC:].any() and not moved.covariance[..., KINEMATIC, :].any()
