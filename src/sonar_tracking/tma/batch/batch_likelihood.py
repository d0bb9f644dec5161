"""Maximum likelihood of a constant-velocity target over a whole batch of frames.

Levenberg-Marquardt on the motion, the source frequencies eliminated (variable projection), from
several initial ranges; many runs at once. Without process noise in the truth it is efficient. With
it, the estimate is still good but its covariance is far too small: then use
:mod:`sonar_tracking.tma.batch.batch_smoother`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.time import seconds
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

INITIAL_DAMPING, DAMPING_DOWN, DAMPING_UP = 1e-2, 0.2, 8.0
"""Of Levenberg and Marquardt, relative to the diagonal of the normal matrix."""


@dataclass(frozen=True)
class BatchConfiguration:
    """Parameters of the batch estimator."""

    start_ranges: tuple[float, ...] = parameter(
        (1500.0, 4000.0, 8000.0, 15_000.0), "Ranges to start from", unit="m", minimum=1.0
    )
    iterations: int = parameter(40, "Steps from each start", minimum=1)
    huber: float = parameter(
        0.0, "Residuals beyond this many deviations count linearly; 0 = all squared", minimum=0.0
    )


@dataclass(frozen=True)
class BatchEstimate:
    """Motion at the last frame.

    Attributes
    ----------
    mean : ndarray, shape (n_runs, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n_runs, 4, 4)
        Of the mean, m^2, m^2/s, m^2/s^2; of a constant-velocity target.
    source_frequency : ndarray, shape (n_runs, n_lines)
        Hz; NaN = never heard.
    cost : ndarray, shape (n_runs,)
        Half the sum of the (robust) normalised squared residuals, pure numbers.
    """

    mean: FloatArray
    covariance: FloatArray
    source_frequency: FloatArray
    cost: FloatArray


@dataclass(frozen=True)
class _Data:
    """Frames stacked: (n_runs, n_frames, ...) or without the runs where common to all."""

    before: FloatArray
    position: FloatArray
    velocity: FloatArray
    azimuth: FloatArray
    azimuth_deviation: FloatArray
    frequency: FloatArray
    frequency_deviation: FloatArray
    sound_speed: float


@dataclass(frozen=True)
class _Point:
    """Cost, gradient and normal matrix at a motion."""

    cost: FloatArray
    gradient: FloatArray
    normal: FloatArray
    source: FloatArray


def estimate_batch_likelihood(
    measurements: Sequence[TmaMeasurement], configuration: BatchConfiguration | None = None
) -> BatchEstimate:
    """Return the most likely motion of every run.

    Parameters
    ----------
    measurements : sequence of TmaMeasurement
        All frames in order, with one leading dimension of runs and one azimuth each.
    configuration : BatchConfiguration, optional
        Parameters of the search.
    """
    parameters = configuration or BatchConfiguration()
    data = _stack(measurements)
    best: tuple[FloatArray, _Point] | None = None
    for start_range in parameters.start_ranges:
        motion, point = _descend(_start(data, start_range), data, parameters)
        if best is None:
            best = motion, point
            continue
        better = point.cost < best[1].cost
        best = _choose(better, motion, best[0]), _choose_point(better, point, best[1])
    assert best is not None
    motion, point = best
    heard = np.any(np.isfinite(data.frequency), axis=1)
    covariance = np.asarray(np.linalg.inv(point.normal), dtype=np.float64)
    return BatchEstimate(motion, covariance, np.where(heard, point.source, np.nan), point.cost)


def _stack(measurements: Sequence[TmaMeasurement]) -> _Data:
    last = measurements[-1].stamp
    shape = measurements[0].frequency.shape
    azimuth = np.stack([one.azimuth[..., 0] for one in measurements], axis=1)
    variance = np.stack(
        [np.broadcast_to(one.azimuth_variance, shape[:1]) for one in measurements], axis=1
    )
    return _Data(
        before=np.array([seconds(one.stamp - last) for one in measurements]),
        position=np.stack([one.position for one in measurements]),
        velocity=np.stack([one.velocity for one in measurements]),
        azimuth=azimuth,
        azimuth_deviation=np.sqrt(variance),
        frequency=np.stack([one.frequency for one in measurements], axis=1),
        frequency_deviation=np.stack([one.frequency_deviation for one in measurements], axis=1),
        sound_speed=measurements[-1].sound_speed,
    )


def _start(data: _Data, start_range: float) -> FloatArray:
    """Return a motion through the first azimuth and the last one at the same range."""
    ends = []
    for frames, own in ((slice(0, 5), data.position[0]), (slice(-5, None), data.position[-1])):
        azimuth = data.azimuth[:, frames]
        mean = np.arctan2(np.nanmean(np.sin(azimuth), 1), np.nanmean(np.cos(azimuth), 1))
        ends.append(own + start_range * np.stack([np.cos(mean), np.sin(mean)], axis=-1))
    velocity = (ends[1] - ends[0]) / max(-float(data.before[0]), 1e-9)
    speed = np.hypot(velocity[:, 0], velocity[:, 1])[:, None]
    velocity = velocity * np.minimum(1.0, 10.0 / np.maximum(speed, 1e-9))
    return np.concatenate([ends[1], velocity], axis=-1)


def _descend(
    motion: FloatArray, data: _Data, parameters: BatchConfiguration
) -> tuple[FloatArray, _Point]:
    point = _point(motion, data, parameters.huber)
    damping = np.full(len(motion), INITIAL_DAMPING)
    for _ in range(parameters.iterations):
        diagonal = np.einsum("rii->ri", point.normal)
        damped = point.normal + (damping[:, None] * diagonal)[:, :, None] * np.eye(4)
        step = np.linalg.solve(damped, point.gradient[..., None])[..., 0]
        trial = motion + step
        there = _point(trial, data, parameters.huber)
        better = there.cost < point.cost
        motion = _choose(better, trial, motion)
        gain = np.max((point.cost - there.cost)[better], initial=0.0)
        point = _choose_point(better, there, point)
        damping = np.where(better, damping * DAMPING_DOWN, damping * DAMPING_UP)
        if gain < 1e-6 and np.all(better | (damping > 1e3)):
            break
    return motion, point


def _point(motion: FloatArray, data: _Data, huber: float) -> _Point:
    """Return the cost and its derivatives, the source frequencies at their best."""
    offset = motion[:, None, :2] + motion[:, None, 2:] * data.before[:, None] - data.position
    distance = np.maximum(np.hypot(offset[..., 0], offset[..., 1]), 1.0)[..., None]
    direction = offset / distance
    relative = motion[:, None, 2:] - data.velocity
    rate = np.sum(direction * relative, axis=-1)
    normal = np.stack([-direction[..., 1], direction[..., 0]], axis=-1)

    by_azimuth = _on_motion(normal / distance, 0.0 * normal, data.before)
    residual = wrap_angle(data.azimuth - np.arctan2(offset[..., 1], offset[..., 0]))
    cost, weight = _robust(residual / data.azimuth_deviation, huber)
    weight = weight / data.azimuth_deviation**2
    gradient = np.einsum("rk,rki->ri", weight * np.nan_to_num(residual), by_azimuth)
    information = np.einsum("rk,rki,rkj->rij", weight, by_azimuth, by_azimuth)

    across = (relative - rate[..., None] * direction) / distance
    doppler = _on_motion(across, direction, data.before)
    factor = 1.0 - rate / data.sound_speed
    sources = np.empty((len(motion), data.frequency.shape[-1]))
    for line in range(sources.shape[1]):
        received, deviation = data.frequency[..., line], data.frequency_deviation[..., line]
        source, line_cost, weight = _best_source(received, factor, deviation, huber)
        own = np.sum(weight * factor**2, axis=1)
        safe = np.where(own > 0.0, own, 1.0)
        common = np.einsum("rk,rki->ri", weight * factor, doppler) / safe[:, None]
        left = doppler - factor[..., None] * common[:, None, :]
        left *= (-source / data.sound_speed)[:, None, None]
        misfit = np.nan_to_num(received - source[:, None] * factor)
        gradient += np.einsum("rk,rki->ri", weight * misfit, left)
        information += np.einsum("rk,rki,rkj->rij", weight, left, left)
        cost = cost + line_cost
        sources[:, line] = source
    return _Point(cost, gradient, information, sources)


def _best_source(
    received: FloatArray, factor: FloatArray, deviation: FloatArray, huber: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the best source frequency of one line, its cost, and the weights of the frames."""
    heard = np.isfinite(received)
    weight = np.where(heard, deviation**-2.0, 0.0)
    ratio = np.where(heard, received / factor, np.nan)
    if huber and np.any(heard):
        # Start from a value that outliers cannot move; then reweight.
        some = np.any(heard, axis=1)
        source = np.zeros(len(received))
        source[some] = np.nanmedian(ratio[some], axis=1)
    else:
        source = _weighted_source(received, factor, weight)
    for _ in range(3 if huber else 0):
        _, robust = _robust((received - source[:, None] * factor) / deviation, huber)
        source = _weighted_source(received, factor, weight * robust)
    cost, robust = _robust((received - source[:, None] * factor) / deviation, huber)
    return source, cost, weight * robust


def _weighted_source(received: FloatArray, factor: FloatArray, weight: FloatArray) -> FloatArray:
    own = np.sum(weight * factor**2, axis=1)
    both = np.sum(weight * factor * np.nan_to_num(received), axis=1)
    return np.asarray(both / np.where(own > 0.0, own, 1.0))


def _robust(normalised: FloatArray, huber: float) -> tuple[FloatArray, FloatArray]:
    """Return the cost summed over frames, and the weight of each; NaN residuals have neither."""
    size = np.abs(np.nan_to_num(normalised))
    there = np.isfinite(normalised)
    if not huber:
        return 0.5 * np.sum(size**2, axis=1), there.astype(np.float64)
    cost = np.where(size > huber, huber * (size - 0.5 * huber), 0.5 * size**2)
    weight = np.where(size > huber, huber / np.maximum(size, huber), 1.0)
    return np.sum(cost, axis=1), np.where(there, weight, 0.0)


def _on_motion(by_position: FloatArray, by_velocity: FloatArray, before: FloatArray) -> FloatArray:
    """Refer derivatives at each frame to the motion at the last one."""
    return np.concatenate([by_position, by_position * before[:, None] + by_velocity], axis=-1)


def _choose(which: BoolArray, one: FloatArray, other: FloatArray) -> FloatArray:
    return np.where(which.reshape(-1, *(1,) * (one.ndim - 1)), one, other)


def _choose_point(which: BoolArray, one: _Point, other: _Point) -> _Point:
    return _Point(
        _choose(which, one.cost, other.cost),
        _choose(which, one.gradient, other.gradient),
        _choose(which, one.normal, other.normal),
        _choose(which, one.source, other.source),
    )
