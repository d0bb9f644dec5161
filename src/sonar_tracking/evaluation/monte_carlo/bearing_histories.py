"""Track histories of many runs and the figures of merit of bearing studies.

A run is successful if every target's bearing error stays below 3 degrees in the last five sample
times. The published mean square errors are over successful runs only, which hides the failures:
the share of successful runs, the median over all runs and the root mean square error over all runs
therefore stand beside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.consistency import chi_square_band
from sonar_tracking.records.arrays import BoolArray, FloatArray

SUCCESS_ERROR = np.radians(3.0)
"""Largest bearing error of a successful run in its last steps, rad."""

SUCCESS_STEPS = 5
"""How many last steps count for success."""


@dataclass(frozen=True)
class BearingHistories:
    """What one tracker did in many runs; track n is meant for target n.

    Attributes
    ----------
    angle : ndarray, shape (..., n_runs, n_steps, n_targets)
        Filtered bearings, rad; NaN where there was no track.
    nis, nees : ndarray, shape (..., n_runs, n_steps, n_targets)
        Normalised innovation and error squared per dimension, pure numbers; NaN where
        undefined.
    swaps : ndarray, shape (..., n_runs)
        Count of lasting identity swaps.
    """

    angle: FloatArray
    nis: FloatArray
    nees: FloatArray
    swaps: FloatArray


def joined(parts: Sequence[BearingHistories]) -> BearingHistories:
    """Join the histories of several batches of runs.

    Parameters
    ----------
    parts : sequence of BearingHistories
        Equal but for the number of runs.
    """
    return BearingHistories(
        angle=np.concatenate([part.angle for part in parts], axis=-3),
        nis=np.concatenate([part.nis for part in parts], axis=-3),
        nees=np.concatenate([part.nees for part in parts], axis=-3),
        swaps=np.concatenate([part.swaps for part in parts], axis=-1),
    )


def normalised_innovation_squared(
    innovation: FloatArray, measurement_variance: FloatArray, filtered_variance: FloatArray
) -> FloatArray:
    """NIS of a scalar measurement, from what a track publishes.

    With predicted variance p of the measured quantity and measurement variance R its filtered
    variance is pR/(p + R), so that the innovation variance p + R is R^2/(R - filtered).

    Parameters
    ----------
    innovation : ndarray, shape (...)
        rad.
    measurement_variance : ndarray, shape (...)
        R, rad^2.
    filtered_variance : ndarray, shape (...)
        Of the measured quantity after the update, rad^2.

    Returns
    -------
    ndarray, shape (...)
        Pure number; NaN where there was no measurement.
    """
    innovation_variance = measurement_variance**2 / (measurement_variance - filtered_variance)
    return innovation**2 / innovation_variance


def successful(angle: FloatArray, truth: FloatArray) -> BoolArray:
    """Tell which runs are successful.

    Parameters
    ----------
    angle : ndarray, shape (..., n_steps, n_targets)
        Filtered bearings, rad.
    truth : ndarray, shape (n_steps, n_targets)
        True bearings, rad.

    Returns
    -------
    ndarray of bool, shape (...)
        A run without a track where there should be one is not successful.
    """
    last = np.abs(angle - truth)[..., -SUCCESS_STEPS:, :]
    return np.all(last < SUCCESS_ERROR, axis=(-2, -1))


def mean_square_error_deg2(angle: FloatArray, truth: FloatArray) -> FloatArray:
    """Mean square bearing error of each run over its steps and targets.

    Parameters
    ----------
    angle : ndarray, shape (..., n_steps, n_targets)
        Filtered bearings, rad; NaN is left out.
    truth : ndarray, shape (n_steps, n_targets)
        True bearings, rad.

    Returns
    -------
    ndarray, shape (...)
        deg^2; infinite for a run that never had a track.
    """
    squared = np.degrees(angle - truth) ** 2
    known = np.isfinite(squared)
    total = np.sum(np.where(known, squared, 0.0), axis=(-2, -1))
    count = np.count_nonzero(known, axis=(-2, -1))
    return np.where(count > 0, total / np.maximum(count, 1), np.inf)


def bearing_metrics(histories: BearingHistories, truth: FloatArray) -> dict[str, float]:
    """Figures of merit over the runs of one condition.

    Parameters
    ----------
    histories : BearingHistories, shape (n_runs, n_steps, n_targets)
        Of one tracker.
    truth : ndarray, shape (n_steps, n_targets)
        True bearings, rad.

    Returns
    -------
    dict of str to float
        Error figures in deg or deg^2, shares in per cent, NIS and NEES per dimension over the
        successful runs with the 95 % band of a consistent filter for that many runs; NEES of the
        median of all runs.
    """
    kept = successful(histories.angle, truth)
    errors = mean_square_error_deg2(histories.angle, truth)
    n_kept = int(np.count_nonzero(kept))
    metrics = {
        "mse_deg2": float(np.mean(errors[kept])) if n_kept else np.nan,
        "success_percent": 100.0 * n_kept / kept.size,
        "median_mse_deg2": float(np.median(errors)),
        "lost_percent": 100.0 * (kept.size - n_kept) / kept.size,
        "rmse_deg": float(np.sqrt(np.mean(errors))),
        "swaps_per_run": float(np.mean(histories.swaps)),
        "rmse_successful_deg": float(np.sqrt(np.mean(errors[kept]))) if n_kept else np.nan,
    }
    with np.errstate(invalid="ignore"):
        runs = np.nanmean(histories.nees, axis=(-2, -1))
    metrics["median_nees_per_dimension"] = float(np.nanmedian(runs))
    if n_kept:
        for name, values, dimension in (("nis", histories.nis, 1), ("nees", histories.nees, 2)):
            low, high = chi_square_band(dimension, n_kept)
            metrics[f"{name}_per_dimension"] = float(np.nanmean(values[kept]))
            metrics[f"{name}_band_low"] = low
            metrics[f"{name}_band_high"] = high
    return metrics
