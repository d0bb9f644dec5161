"""Recursions of the smoother of linear systems in numpy, the sums in a stated order.

``compiled_linear`` is there if a compiler was when the package was installed; the bits are the
same. Its operations are those written here, one after the other.

References
----------
Rauch, Tung and Striebel, "Maximum likelihood estimates of linear dynamic systems", AIAA J. 3(8),
1965.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import FloatArray

COMPILED = compiled_module("tma.batch.compiled_linear")


@dataclass(frozen=True)
class Recursion:
    """Results of both recursions; filled in place.

    Attributes
    ----------
    mean, covariance : ndarray, shapes (n, size) and (n, size, size)
        Given everything measured, in the units of the state and in these squared.
    ahead_mean, ahead : ndarray, shapes (n, size) and (n, size, size)
        Of the prediction into each instant, in the same units.
    backward : ndarray, shape (n - 1, size, size)
        Gain of each instant on what follows, in units of the state over units of the state.
    roots : ndarray, shape (n, n_rows)
        Diagonal of the Cholesky factor of the covariance that what is measured is judged by, in
        the units of the rows; 1 for rows that are not there.
    squared : ndarray, shape (n,)
        Squared distance of what is measured from the prediction in that covariance, pure number.
    """

    mean: FloatArray
    covariance: FloatArray
    ahead_mean: FloatArray
    ahead: FloatArray
    backward: FloatArray
    roots: FloatArray
    squared: FloatArray

    @classmethod
    def empty(cls, n_times: int, n_rows: int, size: int) -> Recursion:
        """Return room for the results.

        Parameters
        ----------
        n_times, n_rows, size : int
            Instants, rows measured at each, and components of the state.
        """
        states, matrices = (n_times, size), (n_times, size, size)
        return cls(
            *(np.empty(states), np.empty(matrices), np.empty(states), np.empty(matrices)),
            np.empty((n_times - 1, size, size)),
            np.ones((n_times, n_rows)),
            np.zeros(n_times),
        )


def run_recursion(
    start: KalmanState,
    dynamics: tuple[FloatArray, FloatArray],
    rows: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> Recursion:
    """Return the states given everything measured, and how well the measurements agree.

    Parameters
    ----------
    start : KalmanState
        Before the first instant, shapes (size,) and (size, size).
    dynamics : tuple of ndarray, shapes (n, size, size)
        Transition and noise into each instant, in units of the state and in these squared.
    rows : tuple of ndarray, shapes (n, n_rows, size) and (n, n_rows)
        Measurement matrix, what was measured, one over its variance (0 = not there), and the
        variance it is judged by, in the units of the rows.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a covariance is not positive definite; it names the instant.
    """
    arrays = [np.ascontiguousarray(each, dtype=float) for each in (*dynamics, *rows)]
    n_times, n_rows, size = arrays[2].shape
    out = Recursion.empty(n_times, n_rows, size)
    if COMPILED is None:
        failed = _run(start, arrays, out)
    else:
        first = np.concatenate([start.mean, np.ravel(start.covariance)])
        results = (out.mean, out.covariance, out.ahead_mean, out.ahead, out.backward)
        failed = COMPILED.smooth(
            *(first, *arrays, *results, out.roots, out.squared), (n_times, n_rows, size)
        )
    if failed:
        raise np.linalg.LinAlgError(
            f"The covariance at instant {failed - 1} is not positive definite."
        )
    return out


def _run(start: KalmanState, arrays: list[FloatArray], out: Recursion) -> int:
    """Fill the results; return 0, or one more than the first instant that has none."""
    transition, noise, matrix, measured, weight, variance = arrays
    state, spread = start.mean, start.covariance
    for time in range(len(matrix)):
        out.ahead_mean[time] = _product(transition[time], state[:, None])[:, 0]
        moved = _product(transition[time], spread)
        out.ahead[time] = _product(moved, transition[time].T) + noise[time]
        state, spread = out.ahead_mean[time].copy(), out.ahead[time].copy()
        there = np.flatnonzero(weight[time])
        own, values = matrix[time, there], measured[time, there]
        roots, squared = _judged(state, spread, own, values, variance[time, there])
        if roots is None:
            return time + 1
        out.roots[time, : len(there)], out.squared[time] = roots, squared
        for row, value, one in zip(own, values, weight[time, there], strict=True):
            cross = _product(spread, row[:, None])
            total = _product(row[None], cross)[0, 0] + 1.0 / one
            step = (value - _product(row[None], state[:, None])[0, 0]) / total
            state = state + cross[:, 0] * step
            spread = spread - cross * cross.T / total
        out.mean[time], out.covariance[time] = state, spread
    return _smooth_back(transition, out)


def _judged(
    state: FloatArray, spread: FloatArray, rows: FloatArray, values: FloatArray, own: FloatArray
) -> tuple[FloatArray | None, float]:
    """Return the diagonal of the factor and the squared distance; None if there is no factor."""
    inner = _product(rows, _product(spread, rows.T)).T.copy()
    inner.flat[:: len(rows) + 1] += own
    factor, failed = _factorised(inner[None])
    if failed:
        return None, 0.0
    factor = factor[0]
    scaled, squared = np.empty(len(rows)), 0.0
    for a, row in enumerate(rows):
        scaled[a] = values[a] - _product(row[None], state[:, None])[0, 0]
        for b in range(a):
            scaled[a] -= factor[a, b] * scaled[b]
        scaled[a] /= factor[a, a]
        squared += float(scaled[a] * scaled[a])
    return np.diagonal(factor), squared


def _smooth_back(transition: FloatArray, out: Recursion) -> int:
    """Take in at each instant what follows; return one more than the instant that fails, or 0."""
    forwards = _product(transition[1:], out.covariance[:-1])
    factor, failed = _factorised(out.ahead[1:])
    if failed:
        return failed + 1
    size = factor.shape[-1]
    for i in range(size):
        for k in range(i):
            forwards[:, i] -= factor[:, i, k, None] * forwards[:, k]
        forwards[:, i] /= factor[:, i, i, None]
    for i in reversed(range(size)):
        for k in range(i + 1, size):
            forwards[:, i] -= factor[:, k, i, None] * forwards[:, k]
        forwards[:, i] /= factor[:, i, i, None]
    out.backward[:] = np.swapaxes(forwards, -1, -2)
    for time in range(len(out.mean) - 2, -1, -1):
        back = out.backward[time]
        later = (out.mean[time + 1] - out.ahead_mean[time + 1])[:, None]
        out.mean[time] += _product(back, later)[:, 0]
        moved = _product(back, out.covariance[time + 1] - out.ahead[time + 1])
        out.covariance[time] += _product(moved, back.T)
    return 0


def _product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return the product of matrices, shapes (..., n, m) and (..., m, p), summed in order."""
    total = left[..., :, 0, None] * right[..., 0, None, :]
    for k in range(1, left.shape[-1]):
        total += left[..., :, k, None] * right[..., k, None, :]
    return np.asarray(total)


def _factorised(matrices: FloatArray) -> tuple[FloatArray, int]:
    """Return lower Cholesky factors, shape (n, size, size), and one more than the first failure."""
    factor = matrices.copy()
    failed = np.zeros(len(factor), dtype=bool)
    for j in range(factor.shape[-1]):
        for k in range(j):
            factor[:, j:, j] -= factor[:, j:, k] * factor[:, j, k, None]
        failed |= ~(factor[:, j, j] > 0.0)
        root = np.sqrt(np.where(failed, 1.0, factor[:, j, j]))
        factor[:, j:, j] /= root[:, None]
        factor[:, j, j] = root
    return factor, int(np.argmax(failed)) + 1 if failed.any() else 0
