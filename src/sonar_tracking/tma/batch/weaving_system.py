"""A linear system whose target weaves about its mean course, and how much it weaves.

The states of the system become those of the target itself, its deviation from the mean course comes
after all others: see :mod:`~sonar_tracking.tma.estimators.weaving`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.learnt_variances import PRIOR_CHANGES, SHORTEST
from sonar_tracking.tma.batch.linear_smoother import LinearSystem, SmoothedStates
from sonar_tracking.tma.estimators.sensor_frame import DEVIATION
from sonar_tracking.tma.estimators.weaving import (
    Weave,
    add_deviation,
    begin_weave,
    deviation_noise,
    deviation_transition,
)


def weaving_system(system: LinearSystem, intervals: FloatArray, weave: Weave) -> LinearSystem:
    """Return a system of a target that weaves.

    Parameters
    ----------
    system : LinearSystem
        Of a target that goes straight; its first states are x, y, vx, vy.
    intervals : ndarray, shape (n,)
        Before each instant, s.
    weave : Weave
        How it weaves.
    """
    more = (0, DEVIATION)
    covariance = np.pad(system.start.covariance, [more, more])
    begin_weave(covariance, weave)
    transition = np.pad(system.transition, [(0, 0), more, more])
    noise = np.pad(system.noise, [(0, 0), more, more])
    last = np.arange(-DEVIATION, 0)
    transition[:, last, last] = 1.0
    add_deviation(transition, noise, intervals, weave)
    return replace(
        system,
        start=KalmanState(np.pad(system.start.mean, more), covariance),
        transition=transition,
        noise=noise,
        matrix=np.pad(system.matrix, [(0, 0), (0, 0), more]),
    )


def learn_weave(states: SmoothedStates, intervals: FloatArray, weave: Weave, least: Weave) -> Weave:
    """Return how much a target weaves, from what its deviation turned out to be.

    As variances are learnt in :mod:`~sonar_tracking.tma.batch.learnt_variances`, but not below what
    is expected: the first passes would find nothing, and the others then could not.

    Parameters
    ----------
    states : SmoothedStates
        Of a system of a target that weaves.
    intervals : ndarray, shape (n,)
        Before each instant, s.
    weave : Weave
        That the system went by.
    least : Weave
        Expected.
    """
    moved = np.flatnonzero(intervals[1:] > SHORTEST)
    step = np.kron(deviation_transition(intervals[moved + 1], weave), np.eye(2))
    noise = deviation_noise(intervals[moved + 1], replace(weave, speed=1.0))
    unit = np.kron(noise, np.eye(2))
    own = slice(-DEVIATION, None)
    mean, covariance = states.mean[:, own], states.covariance[:, own, own]
    change = mean[moved + 1] - (step @ mean[moved, :, None])[..., 0]
    crossed = step @ states.crossed[moved, own, own]
    left = covariance[moved + 1] - crossed - crossed.swapaxes(-1, -2)
    before = step @ covariance[moved] @ step.swapaxes(-1, -2)
    squared = np.sum(change * np.linalg.solve(unit, change[..., None])[..., 0])
    known = np.einsum("nii->n", np.linalg.solve(unit, left + before)) / max(weave.speed**2, 1e-12)
    known = max(float(np.sum(DEVIATION - known)), 0.0)
    found = (squared + PRIOR_CHANGES * least.speed**2) / (known + PRIOR_CHANGES)
    return replace(weave, speed=max(float(np.sqrt(found)), least.speed))
