"""Maximum a posteriori path of a target over a whole batch of frames, process noise included.

Iterated Kalman smoother: filter and smooth with the measurements linearised along the last path,
until the path stays. It starts from the maximum likelihood motion and is Gauss-Newton on the
posterior of the whole path.

References
----------
Bell, "The iterated Kalman smoother as a Gauss-Newton method", SIAM J. Optimization 4(3), 1994.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.batch_likelihood import BatchEstimate
from sonar_tracking.tma.estimators.hypothesis_bank import (
    SOURCE_FREQUENCY_SPREAD,
    HypothesisBank,
    predict_bank,
    update_bank,
)
from sonar_tracking.tma.estimators.measurement_model import linearise
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration

ITERATIONS = 8
SETTLED = 0.1
"""The path stays when no position moves by more, m."""


@dataclass(frozen=True)
class SmoothedPath:
    """Most probable path.

    Attributes
    ----------
    mean : ndarray, shape (n_runs, n_frames, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n_runs, n_frames, 4, 4)
        Of each, m^2, m^2/s, m^2/s^2.
    source_frequency : ndarray, shape (n_runs, n_lines)
        Hz; NaN = never heard.
    """

    mean: FloatArray
    covariance: FloatArray
    source_frequency: FloatArray


def estimate_batch_path(
    measurements: Sequence[TmaMeasurement],
    start: BatchEstimate,
    configuration: SingleFilterConfiguration | None = None,
) -> SmoothedPath:
    """Return the most probable path of every run.

    Parameters
    ----------
    measurements : sequence of TmaMeasurement
        All frames in order, with one leading dimension of runs and one azimuth each; the first
        one with a finite azimuth.
    start : BatchEstimate
        Maximum likelihood motion of the same frames.
    configuration : SingleFilterConfiguration, optional
        Prior and process noise.
    """
    parameters = configuration or SingleFilterConfiguration()
    prior = _prior(measurements[0], start, parameters)
    path = _straight_path(measurements, start)
    for _ in range(ITERATIONS):
        filtered, predicted = _forward(measurements, prior, path, parameters.acceleration)
        smoothed, covariance = _backward(measurements, filtered, predicted)
        moved = np.max(np.abs(smoothed[..., :2] - path[..., :2]))
        path = smoothed
        if moved < SETTLED:
            break
    source = np.where(np.isfinite(start.source_frequency), path[:, -1, KINEMATIC:], np.nan)
    return SmoothedPath(path[..., :KINEMATIC], covariance[..., :KINEMATIC, :KINEMATIC], source)


def _prior(
    first: TmaMeasurement, start: BatchEstimate, parameters: SingleFilterConfiguration
) -> HypothesisBank:
    bank = parameters.start(first)
    known = np.isfinite(start.source_frequency)
    source = np.where(known, start.source_frequency, 0.0)
    mean, covariance = bank.mean.copy(), bank.covariance.copy()
    lines = np.arange(KINEMATIC, mean.shape[-1])
    mean[..., KINEMATIC:] = source[:, None, :]
    # A line never heard keeps a variance, so that no covariance is singular.
    spread = np.where(known, SOURCE_FREQUENCY_SPREAD * source, 1.0)
    covariance[..., lines, lines] = spread[:, None, :] ** 2
    return replace(bank, mean=mean, covariance=covariance, known=known)


def _straight_path(measurements: Sequence[TmaMeasurement], start: BatchEstimate) -> FloatArray:
    last = measurements[-1].stamp
    before = np.array([elapsed(last, one.stamp) for one in measurements])[:, None]
    source = np.nan_to_num(start.source_frequency)
    path = np.empty((len(start.mean), len(measurements), KINEMATIC + source.shape[-1]))
    path[..., :2] = start.mean[:, None, :2] + start.mean[:, None, 2:] * before
    path[..., 2:KINEMATIC] = start.mean[:, None, 2:]
    path[..., KINEMATIC:] = source[:, None, :]
    return path


def _forward(
    measurements: Sequence[TmaMeasurement],
    prior: HypothesisBank,
    path: FloatArray,
    acceleration: float,
) -> tuple[list[HypothesisBank], list[HypothesisBank]]:
    bank, stamp = prior, measurements[0].stamp
    filtered, predicted = [], []
    for index, measurement in enumerate(measurements):
        bank = predict_bank(bank, elapsed(stamp, measurement.stamp), np.asarray(acceleration))
        stamp = measurement.stamp
        predicted.append(bank)
        along = path[:, None, index]
        rows = linearise(along, measurement, bank.known, measurement.azimuth)
        shift = (rows.derivative @ (bank.mean - along)[..., None])[..., 0]
        rows = replace(rows, innovation=rows.innovation - shift)
        bank = update_bank(bank, rows, np.zeros(1))
        filtered.append(bank)
    return filtered, predicted


def _backward(
    measurements: Sequence[TmaMeasurement],
    filtered: list[HypothesisBank],
    predicted: list[HypothesisBank],
) -> tuple[FloatArray, FloatArray]:
    """Return the smoothed means and covariances, shapes (n_runs, n_frames, ...)."""
    mean, covariance = filtered[-1].mean[:, 0], filtered[-1].covariance[:, 0]
    means, covariances = [mean], [covariance]
    for index in range(len(measurements) - 2, -1, -1):
        interval = elapsed(measurements[index].stamp, measurements[index + 1].stamp)
        transition = np.eye(mean.shape[-1])
        transition[0, 2] = transition[1, 3] = interval
        before, ahead = filtered[index], predicted[index + 1]
        crossed = transition @ before.covariance[:, 0]
        gain = np.swapaxes(np.linalg.solve(ahead.covariance[:, 0], crossed), -1, -2)
        shift = mean - ahead.mean[:, 0]
        mean = before.mean[:, 0] + (gain @ shift[..., None])[..., 0]
        change = gain @ (covariance - ahead.covariance[:, 0]) @ np.swapaxes(gain, -1, -2)
        covariance = before.covariance[:, 0] + 0.5 * (change + np.swapaxes(change, -1, -2))
        means.append(mean)
        covariances.append(covariance)
    return np.stack(means[::-1], axis=1), np.stack(covariances[::-1], axis=1)
