"""Protects the batch estimator: its cost, its optimum and its covariance against plain codings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.batch_likelihood import (
    BatchConfiguration,
    BatchEstimate,
    estimate_batch_likelihood,
)
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

SECOND = 1_000_000_000
TRUTH = np.array([3000.0, 2500.0, -4.0, 3.0])
"""Motion at the last frame."""

SOURCES = np.array([300.0, 210.0])
SOUND_SPEED = 1500.0
TIMES = np.cumsum([0.0, *[5.0, 5.0, 7.0, 3.0, 5.0, 5.0, 8.0, 5.0, 5.0, 4.0, 6.0] * 2])


def own_ship() -> tuple[FloatArray, FloatArray]:
    """Return positions and velocities of own ship, which turns half-way."""
    velocity = np.where(TIMES[:, None] < 60.0, [6.0, 0.0], [0.0, 6.0])
    steps = np.diff(TIMES, prepend=0.0)[:, None] * velocity
    return np.cumsum(steps, axis=0), velocity


def predicted(motion: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return azimuths and Doppler factors of a motion at all frames."""
    position, velocity = own_ship()
    offset = motion[:2] + (TIMES - TIMES[-1])[:, None] * motion[2:] - position
    distance = np.hypot(offset[:, 0], offset[:, 1])
    rate = np.sum(offset * (motion[2:] - velocity), axis=1) / distance
    return np.arctan2(offset[:, 1], offset[:, 0]), 1.0 - rate / SOUND_SPEED


def frames(seed: int | None, n_runs: int = 2, wild: bool = False) -> list[TmaMeasurement]:
    """Return frames of some runs, without noise if there is no seed; deviations vary."""
    generator = np.random.default_rng(0 if seed is None else seed)
    azimuth, factor = predicted(TRUTH)
    deviation = 0.01 * (1.0 + 0.5 * np.sin(TIMES))
    spread = 0.05 * (1.0 + 0.3 * np.cos(TIMES))[:, None] * [1.0, 2.0]
    scale = 0.0 if seed is None else 1.0
    angles = azimuth + scale * deviation * generator.normal(size=(n_runs, len(TIMES)))
    noise = generator.normal(size=(n_runs, len(TIMES), 2))
    heard = factor[:, None] * SOURCES + scale * spread * noise
    if wild:
        angles[:, 5] += 0.5
        heard[:, 8, 0] += 5.0
    position, velocity = own_ship()
    return [
        TmaMeasurement(
            stamp=round(TIMES[k] * SECOND),
            position=position[k],
            velocity=velocity[k],
            azimuth=angles[:, k : k + 1],
            azimuth_variance=np.array(deviation[k] ** 2),
            frequency=heard[:, k],
            frequency_deviation=np.broadcast_to(spread[k], (n_runs, 2)),
            sound_speed=SOUND_SPEED,
        )
        for k in range(len(TIMES))
    ]


def residuals(parameters: FloatArray, measured: list[TmaMeasurement], run: int) -> FloatArray:
    """Return the normalised residuals of motion and source frequencies, NaN where none."""
    azimuth, factor = predicted(parameters[:4])
    parts = []
    for k, frame in enumerate(measured):
        off = wrap_angle(frame.azimuth[run, 0] - azimuth[k])
        parts.append(off / np.sqrt(float(frame.azimuth_variance)))
        parts += list(
            (frame.frequency[run] - factor[k] * parameters[4:]) / frame.frequency_deviation[run]
        )
    return np.array(parts)


def cost(parameters: FloatArray, measured: list[TmaMeasurement], run: int, huber: float) -> float:
    size = np.abs(np.nan_to_num(residuals(parameters, measured, run)))
    linear = huber * (size - 0.5 * huber)
    return float(np.sum(np.where((size > huber) & (huber > 0.0), linear, 0.5 * size**2)))


def found(estimate: BatchEstimate, run: int) -> FloatArray:
    return np.concatenate([estimate.mean[run], estimate.source_frequency[run]])


def jacobian(parameters: FloatArray, measured: list[TmaMeasurement], run: int) -> FloatArray:
    steps = np.diag([1e-2, 1e-2, 1e-5, 1e-5, 1e-4, 1e-4])
    return np.stack(
        [
            (
                residuals(parameters + step, measured, run)
                - residuals(parameters - step, measured, run)
            )
            / (2.0 * np.sum(step))
            for step in steps
        ],
        axis=1,
    )


@pytest.mark.parametrize("huber", [0.0, 1.5])
def test_without_noise_the_motion_is_exact(huber: float) -> None:
    estimate = estimate_batch_likelihood(frames(None), BatchConfiguration(huber=huber))
    for run in range(2):
        assert found(estimate, run) == pytest.approx(np.append(TRUTH, SOURCES), rel=1e-5)
    assert estimate.cost == pytest.approx(np.zeros(2), abs=1e-6)


def test_the_covariance_is_that_of_motion_and_sources_together() -> None:
    measured = frames(None)
    estimate = estimate_batch_likelihood(measured)
    slopes = jacobian(np.append(TRUTH, SOURCES), measured, 0)
    full = np.linalg.inv(slopes.T @ slopes)[:4, :4]
    deviation = np.sqrt(np.diag(full))
    ratio = estimate.covariance[0] / np.outer(deviation, deviation)
    assert ratio == pytest.approx(full / np.outer(deviation, deviation), abs=1e-3)


@pytest.mark.parametrize("huber", [0.0, 1.5])
def test_the_estimate_is_the_least_cost_which_it_states(huber: float) -> None:
    measured = frames(3, wild=huber > 0.0)
    estimate = estimate_batch_likelihood(measured, BatchConfiguration(huber=huber))
    for run in range(2):
        best = found(estimate, run)
        least = cost(best, measured, run, huber)
        assert estimate.cost[run] == pytest.approx(least, rel=1e-9)
        deviation = np.sqrt(np.diag(estimate.covariance[run]))
        for column in range(4):
            for sign in (-1.0, 1.0):
                moved = best.copy()
                moved[column] += 0.1 * sign * deviation[column]
                assert cost(moved, measured, run, huber) > least - 1e-4
        if not huber:
            gradient = jacobian(best, measured, run).T @ residuals(best, measured, run)
            assert gradient[:4] * deviation == pytest.approx(np.zeros(4), abs=2e-2)
            assert gradient[4:] * 0.01 == pytest.approx(np.zeros(2), abs=1e-3)


def test_outliers_move_the_robust_estimate_little() -> None:
    plain = estimate_batch_likelihood(frames(3))
    robust = estimate_batch_likelihood(frames(3, wild=True), BatchConfiguration(huber=1.5))
    squared = estimate_batch_likelihood(frames(3, wild=True))
    deviation = np.sqrt(np.einsum("rii->ri", plain.covariance))
    assert np.all(np.abs(robust.mean - plain.mean) < 1.0 * deviation)
    assert np.any(np.abs(squared.mean - plain.mean) > 3.0 * deviation)


def test_each_run_is_estimated_by_itself_and_what_is_missing_is_left_out() -> None:
    measured = frames(4)
    together = estimate_batch_likelihood(measured)
    for run in range(2):
        alone = [
            replace(
                frame,
                azimuth=frame.azimuth[run : run + 1],
                frequency=frame.frequency[run : run + 1],
                frequency_deviation=frame.frequency_deviation[run : run + 1],
            )
            for frame in measured
        ]
        single = estimate_batch_likelihood(alone)
        assert found(together, run) == pytest.approx(found(single, 0), rel=1e-3)
    gone = [
        replace(
            frame,
            azimuth=np.full((2, 1), np.nan) if k in (7, 11) else frame.azimuth,
            frequency=np.full((2, 2), np.nan) if k in (7, 12) else frame.frequency,
        )
        for k, frame in enumerate(measured)
    ]
    estimate = estimate_batch_likelihood(gone)
    best = found(estimate, 0)
    assert estimate.cost[0] == pytest.approx(cost(best, gone, 0, 0.0), rel=1e-9)
    silent = [
        replace(frame, frequency=frame.frequency * np.array([1.0, np.nan])) for frame in measured
    ]
    estimate = estimate_batch_likelihood(silent)
    assert np.isfinite(estimate.source_frequency).tolist() == [[True, False]] * 2
    assert np.all(np.isfinite(estimate.mean))


def test_the_best_of_all_starts_is_taken_whatever_their_order() -> None:
    measured = frames(5)
    ranges = (1500.0, 4000.0, 8000.0, 15_000.0)
    first = estimate_batch_likelihood(measured, BatchConfiguration(start_ranges=ranges))
    last = estimate_batch_likelihood(measured, BatchConfiguration(start_ranges=ranges[::-1]))
    np.testing.assert_allclose(first.mean, last.mean, rtol=1e-3)
    one = [
        estimate_batch_likelihood(measured, BatchConfiguration(start_ranges=(each,), iterations=3))
        for each in ranges
    ]
    both = estimate_batch_likelihood(
        measured, BatchConfiguration(start_ranges=ranges, iterations=3)
    )
    least = np.min([each.cost for each in one], axis=0)
    assert both.cost == pytest.approx(least)
    for run in range(2):
        winner = int(np.argmin([each.cost[run] for each in one]))
        assert both.mean[run] == pytest.approx(one[winner].mean[run])
        assert both.covariance[run] == pytest.approx(one[winner].covariance[run])


def test_the_search_starts_from_the_first_and_the_last_five_azimuths() -> None:
    """Five at either end at almost one instant, from one place: the start is the truth itself."""
    times = [0, 1, 2, 3, 4, *(n * SECOND for n in (20, 40, 50, 60, 80))]
    times += [100 * SECOND - n for n in (4, 3, 2, 1, 0)]
    measured = []
    for number, stamp in enumerate(times):
        own = np.array([0.0, -1000.0 if 5 <= number < 10 else 0.0])
        x, y = np.array([3000.0, -400.0 + 8.0 * stamp / SECOND]) - own
        azimuth = np.array([[np.arctan2(y, x)]])
        none = np.empty((1, 0))
        measured.append(
            TmaMeasurement(stamp, own, np.zeros(2), azimuth, np.array(1e-4), none, none)
        )
    parameters = BatchConfiguration(start_ranges=(float(np.hypot(3000.0, 400.0)),), iterations=1)
    estimate = estimate_batch_likelihood(measured, parameters)
    assert estimate.mean[0] == pytest.approx([3000.0, 400.0, 0.0, 8.0], abs=1e-3)


def test_every_range_has_a_start_within_a_factor_of_two() -> None:
    ranges = np.geomspace(750.0, 30_000.0, 500)
    factors = ranges[:, None] / BatchConfiguration().start_ranges
    assert np.abs(np.log2(factors)).min(axis=1).max() <= 1.0 + 1e-12
