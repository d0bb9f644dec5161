"""Posterior Cramer-Rao bound: the smallest covariance any estimator can have on a scene.

Information recursion with the Fisher information of each frame averaged over true paths. It is
written with covariances, since the process noise of a frame is not invertible.

References
----------
Tichavsky, Muravchik, Nehorai, "Posterior Cramer-Rao bounds for discrete-time nonlinear filtering",
IEEE Trans. Signal Processing 46(5), 1998.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import (
    SOURCE_FREQUENCY_SPREAD,
    HypothesisBank,
    predict_bank,
)
from sonar_tracking.tma.estimators.measurement_model import linearise
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement


def fisher_information(states: FloatArray, measurement: TmaMeasurement) -> FloatArray:
    """Return the information one frame carries at given true states, averaged over them.

    Parameters
    ----------
    states : ndarray, shape (n_paths, 4 + n_lines)
        True states with the source frequencies, m, m/s and Hz.
    measurement : TmaMeasurement
        Which rows there are and how good: of one path or of all.

    Returns
    -------
    ndarray, shape (4 + n_lines, 4 + n_lines)
        In units of the state to the power -2.
    """
    rows = linearise(
        states[:, None, :], measurement, measurement.heard, measurement.azimuth[..., :1]
    )
    weighted = rows.derivative * (rows.present / rows.variance)[..., None]
    each = np.swapaxes(rows.derivative, -1, -2) @ weighted
    return np.asarray(np.mean(each, axis=(0, 1)))


def posterior_bound(
    paths: FloatArray,
    source_frequency: FloatArray,
    frames: Iterable[TmaMeasurement],
    prior: FloatArray,
    acceleration: float,
) -> Iterator[FloatArray]:
    """Yield the bound on the covariance of the state after each frame.

    Parameters
    ----------
    paths : ndarray, shape (n_paths, n_frames, 4)
        True motions x, y, vx, vy, drawn from the motion model, m and m/s.
    source_frequency : ndarray, shape (n_lines,)
        True, Hz.
    frames : iterable of TmaMeasurement
        One a frame, of the same paths (their values are not used, only which there are).
    prior : ndarray, shape (4, 4)
        Covariance of the motion before the first frame, m^2, m^2/s, m^2/s^2.
    acceleration : float
        Process noise of the motion model, m/s^2.

    Yields
    ------
    ndarray, shape (4 + n_lines, 4 + n_lines)
        In units of the state squared; lines not heard yet have a diffuse variance.
    """
    n_lines = len(source_frequency)
    size = KINEMATIC + n_lines
    covariance = np.zeros((1, size, size))
    covariance[0, :KINEMATIC, :KINEMATIC] = prior
    lines = np.arange(KINEMATIC, size)
    covariance[0, lines, lines] = (SOURCE_FREQUENCY_SPREAD * source_frequency) ** 2
    bank = HypothesisBank(
        np.zeros((1, size)), covariance, np.zeros(1), np.ones(n_lines, dtype=bool)
    )
    stamp: int | None = None
    for index, frame in enumerate(frames):
        interval = 0.0 if stamp is None else elapsed(stamp, frame.stamp)
        stamp = frame.stamp
        bank = predict_bank(bank, interval, np.asarray(acceleration))
        states = np.empty((len(paths), size))
        states[:, :KINEMATIC] = paths[:, index]
        states[:, KINEMATIC:] = source_frequency
        information = fisher_information(states, frame)
        predicted = bank.covariance[0]
        gain = np.linalg.solve(np.eye(size) + information @ predicted, information @ predicted)
        updated = symmetrised(predicted - predicted @ gain)
        bank = HypothesisBank(bank.mean, updated[None], bank.log_weight, bank.known)
        yield updated


def polar_bound(bound: FloatArray, state: FloatArray, position: FloatArray) -> FloatArray:
    """Return the root of the bounds on range, azimuth, course and speed.

    Parameters
    ----------
    bound : ndarray, shape (at least 4, at least 4)
        On the state, m^2, m^2/s, m^2/s^2.
    state : ndarray, shape (4,)
        Mean true state, m and m/s: averaging over directions would turn some of the error
        along the line of sight into error across it.
    position : ndarray, shape (2,)
        Of the sensor, m.

    Returns
    -------
    ndarray, shape (4,)
        m, rad, rad, m/s; course and speed over ground.
    """
    offset, velocity = state[:2] - position, state[2:]
    distance, speed = np.hypot(*offset), np.hypot(*velocity)
    gradients = np.zeros((4, KINEMATIC))
    gradients[0, :2] = offset / distance
    gradients[1, :2] = np.array([-offset[1], offset[0]]) / distance**2
    gradients[2, 2:] = np.array([-velocity[1], velocity[0]]) / speed**2
    gradients[3, 2:] = velocity / speed
    variance = np.einsum("qi,ij,qj->q", gradients, bound[:KINEMATIC, :KINEMATIC], gradients)
    return np.sqrt(variance)
