"""Rows taken into a bank of extended Kalman filters, one after the other.

The rows' errors are independent: the result is the same as all at once, without solving a system of
equations in every component. The sums have a stated order, and ``compiled_conditioning``, which is
there if a compiler was when the package was installed, gives the same bits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows

COMPILED = compiled_module("tma.estimators.compiled_conditioning")


@dataclass(frozen=True)
class Conditioned:
    """What rows say of states.

    Attributes
    ----------
    shift : ndarray, shape (..., n)
        Of the means, in the units of the state.
    covariance : ndarray, shape (..., n, n)
        After the rows, in these units squared.
    squared : ndarray, shape (...)
        Squared distance of the rows from what was expected, in their covariance, pure number.
    log_spread : ndarray, shape (...)
        Log of the determinant of that covariance, in units of the rows squared.
    """

    shift: FloatArray
    covariance: FloatArray
    squared: FloatArray
    log_spread: FloatArray


def condition(covariance: FloatArray, rows: LinearisedRows, whole: BoolArray) -> Conditioned:
    """Return states conditioned on rows; the covariances given may be overwritten.

    Parameters
    ----------
    covariance : ndarray, shape (..., n, n)
        Before, in units of the state squared.
    rows : LinearisedRows
        Linearised at the means. A row that a component does not have has derivative 0,
        innovation 0 and variance 1.
    whole : ndarray of bool, shape (...)
        Where states that no row depends on are not zero for certain.
    """
    n, n_rows, size = covariance.shape[-1], *rows.derivative.shape[-2:]
    shape = covariance.shape[:-2]
    taken = np.flatnonzero(np.logical_or.reduce(rows.present.reshape(-1, n_rows), axis=0))
    after = np.ascontiguousarray(covariance, dtype=float).reshape(-1, n, n)
    innovation = np.ascontiguousarray(rows.innovation, dtype=float).reshape(-1, n_rows)
    variance = np.ascontiguousarray(rows.variance, dtype=float).reshape(-1, n_rows)
    derivative = np.ascontiguousarray(rows.derivative, dtype=float).reshape(-1, n_rows, size)
    along = np.ascontiguousarray(whole).astype(np.int64).ravel()
    shift, squared = np.zeros((len(after), n)), np.zeros(len(after))
    spreads = np.empty((len(taken), len(after)))
    if COMPILED is None:
        for which, length in ((np.flatnonzero(along == 0), size), (np.flatnonzero(along), n)):
            part = after[which, :length, :length]
            given = derivative[which], innovation[which], variance[which]
            own, distance, spreads[:, which] = _condition(part, given, taken)
            after[which, :length, :length], squared[which] = part, distance
            shift[which, :length] = own
    else:
        COMPILED.condition(
            *(after, derivative, innovation, variance, taken, along, shift, squared, spreads),
            (len(after), n, size, n_rows),
        )
    logs = np.add.accumulate(np.log(spreads), axis=0)
    log_spread = logs[-1] if len(logs) else np.zeros(len(after))
    return Conditioned(
        shift.reshape(*shape, n),
        after.reshape(covariance.shape),
        squared.reshape(shape),
        log_spread.reshape(shape),
    )


def _condition(
    covariance: FloatArray, rows: tuple[FloatArray, FloatArray, FloatArray], taken: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Condition covariances in place; return shifts, squared distances and spreads of the rows."""
    derivatives, innovations, variances = rows
    size = derivatives.shape[-1]
    shift, squared = np.zeros(covariance.shape[:-1]), np.zeros(len(covariance))
    spreads = np.empty((len(taken), len(covariance)))
    for entry, row in enumerate(taken):
        own = derivatives[:, row]
        cross = covariance[:, :, 0] * own[:, 0, None]
        for k in range(1, size):
            cross += covariance[:, :, k] * own[:, k, None]
        spread, seen = own[:, 0] * cross[:, 0], own[:, 0] * shift[:, 0]
        for k in range(1, size):
            spread += own[:, k] * cross[:, k]
            seen += own[:, k] * shift[:, k]
        spread += variances[:, row]
        root, left = np.sqrt(spread), innovations[:, row] - seen
        cross /= root[:, None]
        shift += cross * (left / root)[:, None]
        covariance -= cross[:, :, None] * cross[:, None, :]
        squared += left * left / spread
        spreads[entry] = spread
    return shift, squared, spreads
