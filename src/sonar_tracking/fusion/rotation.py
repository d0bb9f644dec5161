"""Turning a target about a place: what an error of a direction does to position and velocity."""

from __future__ import annotations

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState, symmetrised
from sonar_tracking.records.arrays import FloatArray


def rotated(state: KalmanState, centre: FloatArray, angle: float, variance: float) -> KalmanState:
    """Return a target turned about a place by an angle that is not known exactly.

    Parameters
    ----------
    state : KalmanState
        x, y, vx, vy; m and m/s; m^2, m^2/s, m^2/s^2.
    centre : ndarray, shape (2,)
        m.
    angle, variance : float
        Anticlockwise, rad and rad^2.
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.zeros((4, 4))
    turn[:2, :2] = turn[2:, 2:] = [[cosine, -sine], [sine, cosine]]
    about = np.concatenate([centre, np.zeros(2)])
    offset = turn @ (state.mean - about)
    change = np.array([-offset[1], offset[0], -offset[3], offset[2]])
    covariance = turn @ state.covariance @ turn.T + variance * np.outer(change, change)
    return KalmanState(about + offset, symmetrised(covariance))
