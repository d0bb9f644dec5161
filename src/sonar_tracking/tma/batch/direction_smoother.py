"""Most probable path of one target from all directions that fixed or known stations measured.

Iterated Kalman smoother on [x, y, vx, vy] with measurement noise that has Student's t distribution:
each pass linearises at the path of the last one and weighs every direction by how well that path
explains it, (nu + 1) / (nu + t^2) with t its residual in standard deviations. The first passes take
the deviations several times wider, so that the start need not be good and stretches of outliers do
not hold the path. Seconds of silence are bridged by the motion.

Errors that do not average out (the array's shape, reflections) are no part of the weights; they
are added to the covariance: an honest claim rests on how many independent directions there were.

References
----------
Aravkin, Burke, Pillonetto, "Robust and trend-following Student's t Kalman smoothers", SIAM J.
Control and Optimization 52(5), 2014, of which this is the reweighted form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.learnt_variances import unit_noise
from sonar_tracking.tma.batch.linear_smoother import LinearSystem, smooth_linear
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC

WIDENING = (8.0, 4.0, 2.0)
"""Factors of the deviations in the first passes."""

MINIMUM_RANGE, MINIMUM_COSINE = 1.0, 0.05
"""Overhead an azimuth says nothing; m, and cosine of the elevation."""

START_DEVIATION = 3000.0
"""Of the first position, m: no matter beside the directions."""


@dataclass(frozen=True)
class DirectionSmootherConfiguration:
    """Parameters of the smoother."""

    acceleration: float = parameter(0.01, "Process noise", unit="m/s^2", minimum=1e-6)
    maximum_speed: float = parameter(20.0, "Of the target, per axis", unit="m/s", minimum=0.1)
    degrees_of_freedom: float = parameter(
        3.0, "Of Student's t distribution; fewer = more outliers", minimum=1.0
    )
    systematic_deviation_deg: float = parameter(
        0.6, "Of direction errors that do not average out", unit="deg", minimum=0.0
    )
    passes: int = parameter(8, "Passes, the widened ones included", minimum=4)


@dataclass(frozen=True)
class DirectionHistory:
    """Directions in order of time, of one station or of several.

    Attributes
    ----------
    times : ndarray, shape (n,)
        s.
    position : ndarray, shape (n, 2)
        Of the station, m.
    height : ndarray, shape (n,)
        Known height of the target above the station, m.
    azimuth : ndarray, shape (n,)
        rad.
    elevation : ndarray, shape (n,)
        rad; NaN = none.
    deviation : ndarray, shape (n,)
        Standard deviation of the direction, rad; an azimuth has it over cos(elevation).
    """

    times: FloatArray
    position: FloatArray
    height: FloatArray
    azimuth: FloatArray
    elevation: FloatArray
    deviation: FloatArray


@dataclass(frozen=True)
class SmoothedTrack:
    """Most probable path.

    Attributes
    ----------
    mean : ndarray, shape (n, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n, 4, 4)
        Of each, systematic errors included, m^2, m^2/s, m^2/s^2.
    """

    mean: FloatArray
    covariance: FloatArray


@dataclass(frozen=True)
class _Rows:
    """Across and up: residuals (n, 2) and their derivatives by the position (n, 2, 2)."""

    residual: FloatArray
    derivative: FloatArray


def smooth_directions(
    history: DirectionHistory,
    start: FloatArray,
    configuration: DirectionSmootherConfiguration | None = None,
) -> SmoothedTrack:
    """Return the most probable path.

    Parameters
    ----------
    history : DirectionHistory
        All directions.
    start : ndarray, shape (n, 2)
        Positions to start from, m: of a filter.
    configuration : DirectionSmootherConfiguration, optional
        Parameters.
    """
    parameters = configuration or DirectionSmootherConfiguration()
    motion, path = _motion(history.times, parameters), start
    mean, covariance = np.empty(0), np.empty(0)
    for number in range(parameters.passes):
        widening = WIDENING[number] if number < len(WIDENING) else 1.0
        states = smooth_linear(_system(history, path, motion, widening, parameters))
        mean, covariance = states.mean, states.covariance
        path = mean[:, :2]
    systematic = float(np.radians(parameters.systematic_deviation_deg))
    covariance[:, :2, :2] += systematic_covariance(history, path, systematic)
    return SmoothedTrack(mean, covariance)


def systematic_covariance(
    history: DirectionHistory, path: FloatArray, deviation: float
) -> FloatArray:
    """Return what one systematic direction error of every station does to each position.

    Parameters
    ----------
    history : DirectionHistory
        Whose stations measured, and which of them elevations too.
    path : ndarray, shape (n, 2)
        Positions at the times of the history, m.
    deviation : float
        Standard deviation of the systematic errors, rad.

    Returns
    -------
    ndarray, shape (n, 2, 2)
        m^2.
    """
    information = np.zeros((len(path), 2, 2))
    stations, number = np.unique(history.position, axis=0, return_inverse=True)
    for station in range(len(stations)):
        own = number == station
        rise = bool(np.any(np.isfinite(history.elevation[own])))
        here = DirectionHistory(
            history.times,
            np.broadcast_to(stations[station], path.shape),
            np.full(len(path), np.median(history.height[own])),
            history.azimuth,
            history.elevation,
            history.deviation,
        )
        derivative = _rows(here, path).derivative[:, : 2 if rise else 1]
        information += np.einsum("nai,naj->nij", derivative, derivative)
    # A position that its stations cannot fix at all is claimed no better than the start.
    floor = np.eye(2) * (deviation / START_DEVIATION) ** 2
    return np.asarray(deviation**2 * np.linalg.inv(information + floor))


def _rows(history: DirectionHistory, path: FloatArray) -> _Rows:
    offset = path - history.position
    distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), MINIMUM_RANGE)
    direction = offset / distance[:, None]
    elevation = np.arctan2(history.height, distance)
    cosine = np.maximum(np.cos(elevation), MINIMUM_COSINE)
    across = wrap_angle(history.azimuth - np.arctan2(offset[:, 1], offset[:, 0])) * cosine
    up = history.elevation - elevation
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    slope = -history.height / (distance**2 + history.height**2)
    derivative = np.stack(
        [normal * (cosine / distance)[:, None], direction * slope[:, None]], axis=1
    )
    return _Rows(np.stack([across, up], axis=1), derivative)


def _motion(
    times: FloatArray, parameters: DirectionSmootherConfiguration
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the covariance before the first time, and transition and noise into each time."""
    speed = parameters.maximum_speed / np.sqrt(3.0)
    spread = np.diag([START_DEVIATION] * 2 + [speed] * 2) ** 2
    intervals = np.diff(times, prepend=times[0])
    transition = np.tile(np.eye(KINEMATIC), (len(intervals), 1, 1))
    transition[:, 0, 2] = transition[:, 1, 3] = intervals
    return spread, transition, parameters.acceleration**2 * unit_noise(intervals)


def _system(
    history: DirectionHistory,
    path: FloatArray,
    motion: tuple[FloatArray, FloatArray, FloatArray],
    widening: float,
    parameters: DirectionSmootherConfiguration,
) -> LinearSystem:
    """Return the system linearised at a path, its directions weighed."""
    freedom, (spread, transition, noise) = parameters.degrees_of_freedom, motion
    rows = _rows(history, path)
    there = np.isfinite(rows.residual)
    residual = np.where(there, rows.residual, 0.0)
    variance = np.broadcast_to((widening * history.deviation[:, None]) ** 2, residual.shape)
    weight = (freedom + 1.0) / (freedom + residual**2 / variance) / variance
    return LinearSystem(
        start=KalmanState(np.concatenate([path[0], np.zeros(2)]), spread),
        transition=transition,
        noise=noise,
        matrix=np.pad(rows.derivative, [(0, 0), (0, 0), (0, KINEMATIC - 2)]),
        # What was measured, referred to positions instead of to errors of the last path.
        measured=residual + np.einsum("nai,ni->na", rows.derivative, path),
        weight=np.where(there, weight, 0.0),
        variance=variance,
        degrees_of_freedom=freedom,
    )
