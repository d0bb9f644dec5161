"""Protects the smoothed path: it is that of one least-squares problem over all frames at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.batch_likelihood import estimate_batch_likelihood
from sonar_tracking.tma.batch.batch_smoother import estimate_batch_path
from sonar_tracking.tma.estimators.measurement_model import linearise
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration
from tests.tma.batch.test_batch_likelihood import SECOND, frames

CONFIGURATION = SingleFilterConfiguration(acceleration=0.05)
SIZE = 6
"""Motion and two source frequencies."""


def least_squares(
    measured: list[TmaMeasurement], path: FloatArray, sources: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of all states, linearised at a path, from one normal matrix."""
    count = len(measured)
    along = np.concatenate([path, np.broadcast_to(sources, (count, 2))], axis=1)
    normal, right = np.zeros((count * SIZE, count * SIZE)), np.zeros(count * SIZE)

    def own(index: int) -> slice:
        return slice(index * SIZE, (index + 1) * SIZE)

    prior = CONFIGURATION.start(measured[0])
    spread = np.diag([0.0] * 4 + list((sources / 6.0) ** 2))
    mean = np.concatenate([prior.mean[0, 0, :4], sources])
    spread[:4, :4] = prior.covariance[0, 0, :4, :4]
    ratio = np.sqrt(spread[4, 4] / sources[0] ** 2)
    assert ratio == pytest.approx(1.0 / 6.0)
    normal[own(0), own(0)] += np.linalg.inv(spread)
    right[own(0)] += np.linalg.solve(spread, mean)
    for index in range(count - 1):
        interval = (measured[index + 1].stamp - measured[index].stamp) / SECOND
        motion = np.eye(SIZE) + interval * np.eye(SIZE, k=2) * np.array([1.0] * 4 + [0.0] * 2)
        block = np.array([[interval**3 / 3.0, interval**2 / 2.0], [interval**2 / 2.0, interval]])
        noise = 1e-9 * np.eye(SIZE)  # sources keep their frequency
        noise[:4, :4] = 0.05**2 * np.kron(block, np.eye(2))
        weight = np.linalg.inv(noise)
        normal[own(index), own(index)] += motion.T @ weight @ motion
        normal[own(index), own(index + 1)] -= motion.T @ weight
        normal[own(index + 1), own(index)] -= weight @ motion
        normal[own(index + 1), own(index + 1)] += weight
    for index, frame in enumerate(measured):
        rows = linearise(along[None, None, index], frame, np.ones((1, 2), bool), frame.azimuth)
        slope, variance = rows.derivative[0, 0], rows.variance[0, 0]
        target = rows.innovation[0, 0] + slope @ along[index]
        normal[own(index), own(index)] += slope.T @ (slope / variance[:, None])
        right[own(index)] += slope.T @ (target / variance)
    covariance = np.linalg.inv(normal)
    states = (covariance @ right).reshape(count, SIZE)
    blocks = np.stack([covariance[own(k), own(k)] for k in range(count)])
    return states[:, :4], blocks[:, :4, :4]


def test_the_path_is_the_fixed_point_of_least_squares() -> None:
    measured = frames(6, n_runs=1)
    start = estimate_batch_likelihood(measured)
    path = estimate_batch_path(measured, start, CONFIGURATION)
    states, covariance = least_squares(measured, path.mean[0], path.source_frequency[0])
    deviation = np.sqrt(np.einsum("nii->ni", covariance))
    assert np.max(np.abs(states - path.mean[0]) / deviation) < 0.02
    scale = deviation[:, :, None] * deviation[:, None, :]
    np.testing.assert_allclose(path.covariance[0] / scale, covariance / scale, atol=0.02)


def test_lines_never_heard_stay_unknown_and_change_nothing() -> None:
    measured = frames(6, n_runs=1)
    silent = [_without_second_line(frame) for frame in measured]
    start = estimate_batch_likelihood(silent)
    path = estimate_batch_path(silent, start, CONFIGURATION)
    assert np.isfinite(path.source_frequency).tolist() == [[True, False]]
    assert np.all(np.isfinite(path.mean))
    assert np.all(np.linalg.eigvalsh(path.covariance[0]) > 0.0)
    # At the ends a path is known worse than between them.
    position = np.sqrt(path.covariance[0, :, 0, 0] + path.covariance[0, :, 1, 1])
    assert position[len(measured) // 2] < max(position[0], position[-1])


def _without_second_line(frame: TmaMeasurement) -> TmaMeasurement:
    return replace(frame, frequency=frame.frequency * np.array([1.0, np.nan]))
