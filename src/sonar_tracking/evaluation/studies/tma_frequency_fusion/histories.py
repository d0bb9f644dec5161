"""Errors of position estimates over many runs, and the figures made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import polar
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns
from sonar_tracking.tma.estimators.estimator import Estimator

LOST_BOUNDS = 5.0
"""A run whose range error exceeds so many bounds is lost."""


@dataclass(frozen=True)
class TmaHistories:
    """What one estimator did in many runs.

    Attributes
    ----------
    error : ndarray, shape (n_runs, n_frames, 4)
        Range (m), azimuth (deg), course (deg), speed (m/s): estimate minus truth.
    nees : ndarray, shape (n_runs, n_frames)
        Normalised estimation error squared of the state, per dimension, pure numbers.
    manoeuvre : ndarray of bool, shape (n_runs, n_frames)
        Alarms.
    reborn : ndarray of bool, shape (n_runs, n_frames)
        Frames in which any line was started anew.
    """

    error: FloatArray
    nees: FloatArray
    manoeuvre: BoolArray
    reborn: BoolArray


def history_of(estimator: Estimator, runs: TmaRuns) -> TmaHistories:
    """Run an estimator over the frames of a batch.

    Parameters
    ----------
    estimator : Estimator
        A new one.
    runs : TmaRuns
        Measurements and truth.
    """
    estimates = [estimator.update(measurement) for measurement in runs.frames()]
    mean = np.stack([one.mean for one in estimates], axis=1)
    covariance = np.stack([one.covariance for one in estimates], axis=1)
    return TmaHistories(
        polar_errors(mean, runs.truth, runs.scene.sensor_position),
        normalised_squared(mean - runs.truth, covariance),
        np.stack([one.manoeuvre for one in estimates], axis=1),
        np.stack([np.any(one.reborn, axis=-1) for one in estimates], axis=1),
    )


def polar_errors(mean: FloatArray, truth: FloatArray, sensor_position: FloatArray) -> FloatArray:
    """Return the errors in range, azimuth, course and speed.

    Parameters
    ----------
    mean, truth : ndarray, shape (..., 4)
        States x, y, vx, vy, m and m/s.
    sensor_position : ndarray, shape (..., 2)
        m.

    Returns
    -------
    ndarray, shape (..., 4)
        m, deg, deg, m/s.
    """
    error = polar(mean, sensor_position) - polar(truth, sensor_position)
    error[..., 1:3] = np.degrees(wrap_angle(error[..., 1:3]))
    return error


def joined(parts: Sequence[TmaHistories]) -> TmaHistories:
    """Return the runs of several batches as one."""
    return TmaHistories(
        np.concatenate([part.error for part in parts]),
        np.concatenate([part.nees for part in parts]),
        np.concatenate([part.manoeuvre for part in parts]),
        np.concatenate([part.reborn for part in parts]),
    )


def frame_metrics(histories: TmaHistories, bound: FloatArray, frame: int) -> dict[str, float]:
    """Return the figures of one frame.

    Parameters
    ----------
    histories : TmaHistories
        All runs.
    bound : ndarray, shape (n_frames, 4)
        Root of the bounds on the four errors, in their units.
    frame : int
        Number of the frame; negative counts from the end.
    """
    error = histories.error[:, frame]
    rms = np.sqrt(np.mean(error**2, axis=0))
    size = np.abs(error[:, 0])
    return {
        "range_rmse_m": float(rms[0]),
        "bearing_rmse_deg": float(rms[1]),
        "course_rmse_deg": float(rms[2]),
        "speed_rmse_m_s": float(rms[3]),
        "range_median_m": float(np.median(size)),
        "range_per_bound": float(rms[0] / bound[frame, 0]),
        "bearing_per_bound": float(rms[1] / bound[frame, 1]),
        "speed_per_bound": float(rms[3] / bound[frame, 3]),
        "nees_per_dimension": float(np.mean(histories.nees[:, frame])),
        "lost_percent": 100.0 * float(np.mean(size > LOST_BOUNDS * bound[frame, 0])),
    }
