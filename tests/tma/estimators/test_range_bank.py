"""Protects the default estimator: accuracy, honesty, and what it does with bad data."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import (
    TmaHistories,
    history_of,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration

BOUND_S1, BOUND_S2, BOUND_S3 = 80.5, 144.1, 83.2
"""Root of the posterior bound on the range in the last frame, m."""


def runs_of(scene: TmaScene, n_runs: int = 30) -> TmaRuns:
    return simulate_runs(scene, np.random.SeedSequence(11).spawn(n_runs))


def last_range_rmse(histories: TmaHistories) -> float:
    return float(np.sqrt(np.mean(histories.error[:, -1, 0] ** 2)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "limit"), [("S1", 1.35 * BOUND_S1), ("S2", 1.8 * BOUND_S2), ("S3", 1.35 * BOUND_S3)]
)
def test_near_the_bound_and_consistent(name: str, limit: float) -> None:
    histories = history_of(RangeBank(), runs_of(scenario(name)))
    assert last_range_rmse(histories) < limit
    assert 0.6 < np.mean(histories.nees[:, -1]) < 1.5
    assert np.count_nonzero(histories.manoeuvre) <= histories.manoeuvre.size / 4000


@pytest.mark.slow
@pytest.mark.parametrize("angle_deg", [53.0, 90.0, 180.0, 359.7])
def test_turning_the_scene_turns_the_result(angle_deg: float) -> None:
    angle = np.radians(angle_deg)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    runs = runs_of(scenario("S1"), 2)
    one, other = RangeBank(), RangeBank()
    for frame in runs.frames():
        turned = replace(
            frame,
            position=rotation @ frame.position,
            velocity=rotation @ frame.velocity,
            azimuth=frame.azimuth + angle,
        )
        here, there = one.update(frame), other.update(turned)
    expected = np.concatenate([here.mean[:, :2] @ rotation.T, here.mean[:, 2:] @ rotation.T], 1)
    np.testing.assert_allclose(there.mean, expected, rtol=1e-6)


@pytest.mark.slow
def test_true_frame_intervals_are_used() -> None:
    scene = scenario("S1")
    intervals = np.exp(np.random.default_rng(9).uniform(np.log(0.25), np.log(4.0), 400))
    times = np.cumsum(intervals / intervals.mean())
    steps = scene.sensor_velocity[:-1] * np.diff(times)[:, None]
    position = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    histories = history_of(
        RangeBank(), runs_of(replace(scene, times=times, sensor_position=position))
    )
    # The truth's accelerations last a frame each: longer frames make it swerve more than assumed.
    assert np.mean(histories.nees[:, -1]) < 2.0
    assert last_range_rmse(histories) < 2.0 * BOUND_S1


@pytest.mark.slow
def test_a_blackout_is_bridged_by_bearings() -> None:
    scene = scenario("S3")
    heard = scene.heard.copy()
    heard[150:200] = False
    heard[200:, :3] = False
    histories = history_of(RangeBank(), runs_of(replace(scene, heard=heard)))
    assert last_range_rmse(histories) < 1.6 * BOUND_S3


def wild(runs: TmaRuns) -> TmaRuns:
    """Make 5 % of azimuths and frequencies anything."""
    generator = np.random.default_rng(6)
    hit = generator.random(runs.azimuth.shape) < 0.05
    azimuth = np.where(hit, generator.uniform(-np.pi, np.pi, hit.shape), runs.azimuth)
    hit_lines = generator.random(runs.frequency.shape) < 0.05
    off = generator.uniform(-50.0, 50.0, hit_lines.shape)
    return replace(runs, azimuth=azimuth, frequency=runs.frequency + np.where(hit_lines, off, 0.0))


@pytest.mark.slow
def test_outliers_cost_little() -> None:
    runs = runs_of(scenario("S1"), 20)
    clean = last_range_rmse(history_of(RangeBank(), runs))
    assert last_range_rmse(history_of(RangeBank(), wild(runs))) < 1.15 * clean


@pytest.mark.slow
def test_one_run_does_not_depend_on_the_others() -> None:
    runs = runs_of(scenario("S1"), 3)
    alone = replace(runs, truth=runs.truth[:1], azimuth=runs.azimuth[:1])
    alone = replace(alone, frequency=runs.frequency[:1])
    np.testing.assert_allclose(
        history_of(RangeBank(), alone).error[0], history_of(RangeBank(), runs).error[0], rtol=1e-6
    )


def test_missing_and_repeated_frames_leave_a_finite_answer() -> None:
    runs = runs_of(scenario("S1"), 1)
    estimator = RangeBank(RangeBankConfiguration(n_ranges=3))
    for index, frame in enumerate(runs.frames()):
        if 20 < index < 40:
            frame = replace(
                frame,
                azimuth=np.full_like(frame.azimuth, np.nan),
                frequency=np.full_like(frame.frequency, np.nan),
            )
        for _ in range(2 if index == 50 else 1):
            estimate = estimator.update(frame)
        if index == 60:
            break
    assert np.all(np.isfinite(estimate.mean))
    assert np.all(np.linalg.eigvalsh(estimate.covariance) > 0.0)
