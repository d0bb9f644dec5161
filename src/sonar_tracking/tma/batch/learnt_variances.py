"""Variances that a smoother learns from what it has smoothed: of noise, of errors, of motion.

A variance that explains changes d_k of known relative size is learnt by the fixed point

    variance = sum of d_k^2 / (n - sum of P_k / Q_k),

P_k being what is left unknown of each after smoothing and Q_k what the model allows for: where the
data say nothing of the changes the denominator vanishes, and a prior of a few of them decides.

References
----------
MacKay, "Bayesian interpolation", Neural Computation 4(3), 1992, eq. 4.10.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.tma.batch.linear_smoother import SmoothedStates
from sonar_tracking.tma.batch.target_history import HistoryRows, TargetHistory
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC

BLOCK = 60.0
"""Time with one process noise, and over which errors of lines are summed, s."""

LARGEST_ACCELERATION = 2.5
"""Of what turns are looked for with: bearings that ask for more are wrong."""

PRIOR_CHANGES = 2.0
"""So many changes of velocity say that a target moves straight."""

PRIOR_ERRORS = 5.0
"""So many errors say that they are as told, and that none last."""

PRIOR_DEVIATION = 0.1
"""Errors that last, before anything is learnt of them, relative to the deviation told."""

SHORTEST = 1e-3
"""Interval over which anything is learnt, s."""


@dataclass(frozen=True)
class Learnt:
    """What the passes learn.

    Attributes
    ----------
    acceleration : ndarray, shape (n,)
        Process noise before each time, m/s^2.
    largest : float
        That the process noise may have, m/s^2.
    fast : ndarray, shape (n_errors,)
        Standard deviation of each of the faster errors of directions, rad.
    told : ndarray, shape (n_errors,)
        Median deviation told of those directions, rad.
    ratio : ndarray, shape (n_groups,)
        Variance of each group of rows over that told; pure numbers.
    """

    acceleration: FloatArray
    largest: float
    fast: FloatArray
    told: FloatArray
    ratio: FloatArray

    @staticmethod
    def of(history: TargetHistory, acceleration: float, manoeuvre: float) -> Learnt:
        """Return what is taken before the first pass: turns anywhere, errors as told."""
        groups = history.groups
        told = np.zeros(history.n_errors)
        for error in range(history.n_errors):
            own = history.deviations[:, :2][groups[:, :2] == error]
            told[error] = np.median(own[np.isfinite(own)]) if np.isfinite(own).any() else 0.0
        return Learnt(
            acceleration=np.full(len(history.times), max(acceleration, manoeuvre)),
            largest=max(acceleration, LARGEST_ACCELERATION * manoeuvre),
            fast=told,
            told=told,
            ratio=np.ones(int(groups.max(initial=0)) + 1),
        )


def learn(
    history: TargetHistory,
    states: SmoothedStates,
    rows: HistoryRows,
    learnt: Learnt,
    correlation_time: float,
    acceleration: float,
    freedom: float,
) -> Learnt:
    """Return what the states of a pass teach.

    Parameters
    ----------
    history : TargetHistory
        What was measured.
    states : SmoothedStates
        Of the pass.
    rows : HistoryRows
        At these states.
    learnt : Learnt
        What the pass went by.
    correlation_time : float
        Of the faster errors, s.
    acceleration : float
        Process noise of a target that moves straight, m/s^2.
    freedom : float
        Degrees of freedom of Student's t distribution.
    """
    return Learnt(
        acceleration=_accelerations(history, states, learnt, acceleration),
        largest=learnt.largest,
        fast=_lasting_errors(history, states, learnt, correlation_time),
        told=learnt.told,
        ratio=_ratios(history, rows, learnt, freedom),
    )


def unit_noise(intervals: FloatArray) -> FloatArray:
    """Return what the covariance of [x, y, vx, vy] gains with an acceleration of 1 m/s^2.

    Parameters
    ----------
    intervals : ndarray, shape (n,)
        s.

    Returns
    -------
    ndarray, shape (n, 4, 4)
        m^2, m^2/s, m^2/s^2.
    """
    noise = np.zeros((len(intervals), KINEMATIC, KINEMATIC))
    for axis in (0, 1):
        noise[:, axis, axis] = intervals**3 / 3.0
        noise[:, axis, axis + 2] = noise[:, axis + 2, axis] = intervals**2 / 2.0
        noise[:, axis + 2, axis + 2] = intervals
    return noise


def _accelerations(
    history: TargetHistory, states: SmoothedStates, learnt: Learnt, straight: float
) -> FloatArray:
    """Return the process noise of each block, from what the states say moved them."""
    intervals = np.diff(history.times)
    moved = np.flatnonzero(intervals > SHORTEST)
    if not len(moved):
        return learnt.acceleration
    allowed = learnt.acceleration[moved + 1] ** 2
    squared, left = squared_changes(states, moved, intervals[moved])
    known = KINEMATIC - left / allowed
    block = _blocks(history)
    count = int(block[-1]) + 1
    total = np.bincount(block[moved + 1], weights=squared, minlength=count)
    determined = np.bincount(block[moved + 1], weights=known, minlength=count)
    found = total + PRIOR_CHANGES * straight**2
    found /= np.maximum(determined, 0.0) + PRIOR_CHANGES
    return np.asarray(np.clip(np.sqrt(found), straight, learnt.largest)[block])


def squared_changes(
    states: SmoothedStates, moved: IntArray, elapsed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return how much positions and velocities change, and how much of it is left unknown.

    In units of what an acceleration of 1 m/s^2 does, whose covariance is that of
    :func:`unit_noise`. Its inverse is written out for the position and the velocity of each axis.

    Parameters
    ----------
    states : SmoothedStates
        Of [x, y, vx, vy, ...].
    moved : ndarray of int, shape (n,)
        Instants from which to the next ones.
    elapsed : ndarray, shape (n,)
        Time between them, s.

    Returns
    -------
    squared : ndarray, shape (n,)
        Squared changes, m^2/s^4.
    left : ndarray, shape (n,)
        Trace of their covariance, m^2/s^4.
    """
    before, after, crossed = states.covariance[moved], states.covariance[moved + 1], states.crossed
    first, second = states.mean[moved], states.mean[moved + 1]
    both = 12.0 / elapsed**3, -6.0 / elapsed**2, 4.0 / elapsed
    squared, left = np.zeros(len(moved)), np.zeros(len(moved))
    for place, speed in ((0, 2), (1, 3)):
        rate = first[:, speed]
        way = second[:, place] - first[:, place] - elapsed * rate
        faster = second[:, speed] - rate
        squared += both[0] * way**2 + 2.0 * both[1] * way * faster + both[2] * faster**2
        stood, met, ran = (
            before[:, row, column]
            for row, column in ((place, place), (place, speed), (speed, speed))
        )
        # What the state before the step, moved on, has in common with the one after it.
        common = crossed[moved, speed]
        carried = crossed[moved, place] + elapsed[:, None] * common
        met = met + elapsed * ran
        ways = (
            after[:, place, place]
            - 2.0 * carried[:, place]
            + stood
            + elapsed * (before[:, place, speed] + met)
        )
        mixed = after[:, place, speed] - carried[:, speed] - common[:, place] + met
        speeds = after[:, speed, speed] - 2.0 * common[:, speed] + ran
        left += both[0] * ways + 2.0 * both[1] * mixed + both[2] * speeds
    return squared, left


def _lasting_errors(
    history: TargetHistory, states: SmoothedStates, learnt: Learnt, correlation_time: float
) -> FloatArray:
    """Return the deviations of the faster errors of directions."""
    intervals = np.diff(history.times)
    moved = np.flatnonzero(intervals > SHORTEST)
    kept = np.exp(-intervals[moved] / correlation_time)
    unit = 1.0 - kept**2
    found = np.empty(history.n_errors)
    for error, column in enumerate(history.fast):
        value, variance = states.mean[:, column], states.covariance[:, column, column]
        change = value[moved + 1] - kept * value[moved]
        crossed = states.crossed[moved, column, column]
        left = variance[moved + 1] - 2.0 * kept * crossed + kept**2 * variance[moved]
        allowed = max(learnt.fast[error] ** 2, 1e-30)
        total = np.sum(change**2 / unit)
        known = max(float(np.sum(1.0 - left / (unit * allowed))), 0.0)
        small = (PRIOR_DEVIATION * learnt.told[error]) ** 2
        found[error] = np.sqrt((total + PRIOR_ERRORS * small) / (known + PRIOR_ERRORS))
    return found


def _ratios(
    history: TargetHistory, rows: HistoryRows, learnt: Learnt, freedom: float
) -> FloatArray:
    """Return the variance of each group of rows over that told.

    The scale of Student's t distribution, which outliers do not own. Errors of a line may last:
    sums over blocks of what white noise would leave independent tell how much more that is.
    """
    groups, block = history.groups, _blocks(history)
    deviation = np.where(rows.present, history.deviations, 1.0)
    size = rows.residual / (deviation * np.sqrt(learnt.ratio[groups]))
    score = (freedom + 1.0) / (freedom + size**2) * size
    found = learnt.ratio.copy()
    for group in range(len(found)):
        chosen = rows.present & (groups == group)
        if not chosen.any():
            continue
        scale, known = float(np.mean(score[chosen] * size[chosen])), float(np.sum(chosen))
        if group >= 2 * history.n_stations:
            where = np.broadcast_to(block[:, None], chosen.shape)[chosen]
            count = np.bincount(where)
            total = np.bincount(where, weights=score[chosen])[count > 0]
            lasting = float(np.mean(total**2 / count[count > 0]) / np.mean(score[chosen] ** 2))
            scale, known = scale * max(1.0, lasting), float(len(total))
        found[group] *= scale
        found[group] = max(1.0, (PRIOR_ERRORS + known * found[group]) / (PRIOR_ERRORS + known))
    return found


def _blocks(history: TargetHistory) -> IntArray:
    return np.asarray((history.times - history.times[0]) // BLOCK, dtype=np.int64)
