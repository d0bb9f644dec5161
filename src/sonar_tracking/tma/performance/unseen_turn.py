"""How long a turn of a target stays unseen: what can go wrong with a position that is confirmed.

A position holds as long as its target does what it did. If it turns, the filter's innovations have
the means m_k. The ideal detector of :mod:`~sonar_tracking.tma.performance.ideal_turn_detector`
notices it when the deflection d exceeds a number of standard deviations. Without process noise, and
with a target that goes straight from the prior P on, all frames so far weigh at once,

    d^2 = q - b^T J^-1 b,   q = sum m^T R^-1 m,   b = sum H^T R^-1 m,   J = P^-1 + sum H^T R^-1 H,

which are sums over frames: all instants are found together. Frequencies of lines at rest are states
beside the motion, known from as much time before the turn as :data:`BEFORE`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC

NOTICED = 4.0
"""Standard deviations: an alarm in an hour, asked every second."""

TURN, RATE = np.pi / 2.0, np.radians(3.0)
"""By how much and how fast the target turns, rad and rad/s."""

BEFORE, LONGEST = 60.0, 300.0
"""How long before the turn, and after, is looked at, s."""

LEAST_STEP = 2.0
"""Frames that follow each other sooner count as one, s."""

FREQUENCY_SPREAD = 0.01
"""Of a line at rest before it is heard, part of its frequency."""


@dataclass(frozen=True)
class Watch:
    """What a station goes on to measure of a target.

    Attributes
    ----------
    position, velocity : tuple of float
        Of the station, which goes straight, m and m/s.
    azimuth_deviation : float
        Of each azimuth, rad.
    interval : float
        Between frames, s.
    frequencies, frequency_deviations : tuple of float
        Of the lines it hears, Hz.
    sound_speed : float
        m/s.
    height : float
        Of the target above it, where that is known, m.
    elevation_deviation : float
        Of each elevation, rad; inf = it measures none, or the height is not known.
    """

    position: tuple[float, float]
    velocity: tuple[float, float]
    azimuth_deviation: float
    interval: float
    frequencies: tuple[float, ...] = ()
    frequency_deviations: tuple[float, ...] = ()
    sound_speed: float = 1500.0
    height: float = 0.0
    elevation_deviation: float = np.inf


def unseen_for(mean: FloatArray, prior: FloatArray, watches: Sequence[Watch]) -> float:
    """Return how long a turn to the worse side stays unseen, s; LONGEST = so long or longer.

    Parameters
    ----------
    mean : ndarray, shape (4,)
        Of the motion at the turn, m and m/s.
    prior : ndarray, shape (4, 4)
        Its covariance, m^2, m^2/s, m^2/s^2.
    watches : sequence of Watch
        Of the stations that observe it; at least one.
    """
    step = max(LEAST_STEP, *(one.interval for one in watches))
    count = round(BEFORE / step), round(LONGEST / step)
    times = np.arange(-count[0], count[1] + 1).astype(np.float64) * step
    return max(
        _noticed(times, mean, prior, [(one, _shares(one, step)) for one in watches], side)
        for side in (1.0, -1.0)
    )


def _shares(watch: Watch, step: float) -> float:
    """Return how many frames of a station count as one."""
    return max(step / watch.interval, 1.0) if watch.interval > 0.0 else 1.0


def _noticed(
    times: FloatArray,
    mean: FloatArray,
    prior: FloatArray,
    watches: Sequence[tuple[Watch, float]],
    side: float,
) -> float:
    straight = mean[:2] + mean[2:] * times[:, None]
    velocity = np.broadcast_to(mean[2:], straight.shape)
    turned, after = _turned(times, mean, side)
    size = KINEMATIC + sum(len(one.frequencies) for one, _ in watches)
    information = np.zeros((len(times), size, size))
    information[0, :KINEMATIC, :KINEMATIC] = np.linalg.inv(prior)
    shifts = np.zeros((len(times), size))
    squared = np.zeros(len(times))
    place = KINEMATIC
    for watch, share in watches:
        was, seen = _seen(watch, times, straight, velocity), _seen(watch, times, turned, after)
        rows = [
            (was.of_azimuth, wrap_angle(seen.azimuth - was.azimuth), watch.azimuth_deviation),
            (was.of_elevation, seen.elevation - was.elevation, watch.elevation_deviation),
        ]
        for frequency, deviation in zip(watch.frequencies, watch.frequency_deviations, strict=True):
            scale = frequency / watch.sound_speed
            information[0, place, place] = (FREQUENCY_SPREAD * frequency) ** -2
            derivative = np.zeros((len(times), size))
            derivative[:, :KINEMATIC] = -scale * was.of_rate
            derivative[:, place] = 1.0 - was.rate / watch.sound_speed
            rows.append((derivative, -scale * (seen.rate - was.rate), deviation))
            place += 1
        for derivative, shift, deviation in rows:
            full = np.zeros((len(times), size))
            full[:, : derivative.shape[1]] = derivative
            weight = share / deviation**2
            information += weight * full[:, :, None] * full[:, None, :]
            shifts += weight * full * shift[:, None]
            squared += weight * shift**2
    total = np.cumsum(information, axis=0)
    sums = np.cumsum(shifts, axis=0)
    solved = np.linalg.solve(total, sums[..., None])[..., 0]
    deflection = np.cumsum(squared) - np.sum(sums * solved, axis=1)
    noticed = deflection > NOTICED**2
    return float(times[np.argmax(noticed)]) if noticed.any() else LONGEST


@dataclass(frozen=True)
class _Seen:
    """What is measured at each time, rad and m/s, and its derivatives by the motion at time 0."""

    azimuth: FloatArray
    elevation: FloatArray
    rate: FloatArray
    of_azimuth: FloatArray
    of_elevation: FloatArray
    of_rate: FloatArray


def _seen(watch: Watch, times: FloatArray, place: FloatArray, velocity: FloatArray) -> _Seen:
    offset = place - watch.position - np.array(watch.velocity) * times[:, None]
    relative = velocity - watch.velocity
    distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), 1.0)[:, None]
    along = offset / distance
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) / distance
    rate = np.sum(along * relative, axis=1)
    turning = (relative - rate[:, None] * along) / distance
    slope = -watch.height / (distance**2 + watch.height**2) * along
    since = times[:, None]
    return _Seen(
        np.arctan2(offset[:, 1], offset[:, 0]),
        np.arctan2(watch.height, distance[:, 0]),
        rate,
        np.concatenate([across, across * since], axis=1),
        np.concatenate([slope, slope * since], axis=1),
        np.concatenate([turning, turning * since + along], axis=1),
    )


def _turned(times: FloatArray, mean: FloatArray, side: float) -> tuple[FloatArray, FloatArray]:
    """Return positions and velocities of a target that turns at time 0."""
    speed, course = float(np.hypot(*mean[2:])), float(np.arctan2(mean[3], mean[2]))
    turning = np.clip(times, 0.0, TURN / RATE)
    angle = course + side * RATE * turning
    velocity = speed * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    radius = side * speed / RATE
    arc = radius * np.stack(
        [np.sin(angle) - np.sin(course), np.cos(course) - np.cos(angle)], axis=1
    )
    straight = mean[2:] * np.minimum(times, 0.0)[:, None]
    after = velocity * (times - turning)[:, None] * (times > 0.0)[:, None]
    return mean[:2] + straight + arc + after, velocity
