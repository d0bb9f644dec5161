"""What the innovations of a bank say of the errors of what was measured.

They are averaged over the hypotheses of a run: what one of them explains is no error. The sums have
a stated order, and ``compiled_innovations``, which is there if a compiler was when the package was
installed, gives the same bits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.estimators.bank_batch import RunRows
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows, watched_rows
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

COMPILED = compiled_module("tma.estimators.compiled_innovations")

VAGUE = 3.0
"""Where the filter's own variance is larger than the error's by this, the innovation says little
of the error."""

COMPARED_LINES = 3
"""So many lines tell their errors from the motion of the target that they have in common."""


@dataclass(frozen=True)
class BankInnovations:
    """Innovations of the hypotheses of many runs.

    Attributes
    ----------
    runs : RunRows
        Hypotheses of each run.
    weight : ndarray, shape (n_hypotheses, 1)
        Of each hypothesis, after the rows, pure numbers; those of a run sum up to 1.
    rows : LinearisedRows
        Of each hypothesis, shape (n_hypotheses, 1, 2 + n_lines), linearised at its prediction.
    variance : ndarray, shape (n_hypotheses, 1, 2 + n_lines)
        Of the innovations, rad^2 and Hz^2.
    frequency : ndarray, shape (n_runs, n_lines)
        Received, Hz.
    """

    runs: RunRows
    weight: FloatArray
    rows: LinearisedRows
    variance: FloatArray
    frequency: FloatArray


@dataclass(frozen=True)
class ErrorInnovations:
    """What they say of the errors of azimuth and lines.

    Attributes
    ----------
    innovation : ndarray, shape (n_runs, 1 + n_lines)
        Measured minus predicted, in told standard deviations: a pure number.
    own_variance : ndarray, shape (n_runs, 1 + n_lines)
        Of the prediction, in told variances: a pure number.
    telling : ndarray of bool, shape (n_runs, 1 + n_lines)
        Which rows there are and say something of their errors.
    """

    innovation: FloatArray
    own_variance: FloatArray
    telling: BoolArray


def as_of_first_side(
    rows: LinearisedRows, state: FloatArray, measurement: TmaMeasurement
) -> LinearisedRows:
    """Return rows in which one error of a line array's angle looks alike on both of its sides.

    It turns the azimuth on the second side the other way: averaged over hypotheses of both the
    innovations would be nothing, however large the error.

    Parameters
    ----------
    rows : LinearisedRows
        Of each hypothesis, shape (n_hypotheses, 1, 2 + n_lines).
    state : ndarray, shape (n_hypotheses, 1, at least 2)
        x, y, ... predicted, m.
    measurement : TmaMeasurement
        With one azimuth or two.
    """
    if measurement.azimuth.shape[-1] == 1:
        return rows
    offset = state[:, 0, :2] - measurement.position
    expected = np.arctan2(offset[:, 1], offset[:, 0])
    apart = np.abs(wrap_angle(measurement.azimuth - expected[:, None]))
    innovation = rows.innovation.copy()
    innovation[apart[:, 1] < apart[:, 0], 0, 0] *= -1.0
    return replace(rows, innovation=innovation)


def error_innovations(
    seen: BankInnovations, factor: FloatArray, usable: tuple[BoolArray, BoolArray]
) -> ErrorInnovations:
    """Return what the innovations of each run say of the errors.

    Parameters
    ----------
    seen : BankInnovations
        Innovations, with the variances that were learnt.
    factor : ndarray, shape (n_runs, 1 + n_lines)
        By which what was told had been multiplied, pure numbers.
    usable : tuple of ndarray of bool, shapes (n_runs,) and (n_runs, n_lines)
        Which azimuths and lines may say something.
    """
    if COMPILED is None:
        return _error_innovations(seen, factor, usable)
    shape, runs, rows = factor.shape, seen.runs, seen.rows
    found = ErrorInnovations(np.empty(shape), np.empty(shape), np.empty(shape, dtype=bool))
    given = seen.weight, rows.innovation, seen.variance, rows.variance, rows.present, runs.counts
    COMPILED.average(
        *(np.ascontiguousarray(one) for one in (*given, factor, seen.frequency, *usable)),
        *(found.innovation, found.own_variance, found.telling),
        (VAGUE, COMPARED_LINES),
        (len(runs.counts), len(runs.owner), shape[1] - 1),
    )
    return found


def _error_innovations(
    seen: BankInnovations, factor: FloatArray, usable: tuple[BoolArray, BoolArray]
) -> ErrorInnovations:
    runs, rows, weight = seen.runs, seen.rows, seen.weight
    watched = watched_rows(rows)
    innovation = rows.innovation[:, 0, watched]
    present = runs.any(rows.present[:, 0])[:, watched]
    mean = runs.sums(weight * innovation)
    own = (seen.variance - rows.variance)[:, 0, watched] + (innovation - mean[runs.owner]) ** 2
    own = runs.sums(weight * own)
    told = np.where(present, rows.variance[runs.starts, 0][:, watched] / factor, 1.0)
    if present.shape[1] > 1:
        present[:, 1:] &= usable[1]
        mean[:, 1:], own[:, 1:] = without_common_doppler(
            mean[:, 1:], own[:, 1:], seen.frequency, told[:, 1:], present[:, 1:]
        )
    own /= told
    telling = present & (own < VAGUE * factor)
    telling[:, 0] &= usable[0]
    return ErrorInnovations(mean / np.sqrt(told), own, telling)


def without_common_doppler(
    innovation: FloatArray,
    own_variance: FloatArray,
    frequency: FloatArray,
    variance: FloatArray,
    present: BoolArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the innovations of lines, and what the prediction adds to their variance.

    Motion shifts all lines in proportion to their frequencies. Of three and more lines each is
    compared with the others rather than with the prediction: a turn of the target says nothing of
    their errors then.

    Parameters
    ----------
    innovation : ndarray, shape (..., n_lines)
        Measured minus predicted, Hz.
    own_variance, variance : ndarray, shape (..., n_lines)
        Of the prediction, and of the measurement as told, Hz^2.
    frequency : ndarray, shape (..., n_lines)
        Received, Hz.
    present : ndarray of bool, shape (..., n_lines)
        Which lines there are.

    Returns
    -------
    innovation : ndarray, shape (..., n_lines)
        Hz.
    own_variance : ndarray, shape (..., n_lines)
        Hz^2.
    """
    scale = np.where(present, frequency, 1.0)
    weight = np.where(present, scale**2 / variance, 0.0)
    shift = weight * np.where(present, innovation, 0.0) / scale
    others = _summed(weight) - weight
    enough = (np.sum(present, axis=-1, keepdims=True) >= COMPARED_LINES) & present
    others = np.where(enough, others, 1.0)
    common = (_summed(shift) - shift) / others
    return (
        np.where(enough, innovation - scale * common, innovation),
        np.where(enough, scale**2 / others, own_variance),
    )


def _summed(values: FloatArray) -> FloatArray:
    """Return the sum over the last axis, one after the other."""
    return np.asarray(np.add.accumulate(values, axis=-1)[..., -1:])
