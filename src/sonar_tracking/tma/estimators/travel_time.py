"""Sound takes time: a target is seen where it was, and its state is that of now.

What is received at a stamp left the target a travel time t ago, at p = x - t v with t = |p| / c.
The equation is solved by two steps, what is left is of the order of (v / c)^3; derivatives by p are
referred to the state by

    dp = (1 - v u' / (c + u . v)) (dx - t dv),   u = p / |p|.

A source that moves leaves its sound behind, so that the Doppler factor is 1 - u . w / (c + u . v)
with w its velocity relative to the sensor. To first order in v / c that is 1 - u . w / c; lines
that are good to 1e-5 tell them apart.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC


def offset_seen(
    mean: FloatArray, position: FloatArray, propagation_speed: FloatArray | float
) -> tuple[FloatArray, FloatArray]:
    """Return where a target seems to be, from a sensor, and how long ago it was there.

    Parameters
    ----------
    mean : ndarray, shape (..., at least 4)
        States x, y, vx, vy, m and m/s.
    position : ndarray, shape (..., 2) or (2,)
        Of the sensor, m.
    propagation_speed : float or ndarray, shape (...)
        m/s; inf = seen at once.

    Returns
    -------
    offset : ndarray, shape (..., 2)
        m.
    delay : ndarray, shape (...)
        s.
    """
    now = mean[..., :2] - position
    delay = np.hypot(now[..., 0], now[..., 1]) / propagation_speed
    then = now - delay[..., None] * mean[..., 2:KINEMATIC]
    delay = np.hypot(then[..., 0], then[..., 1]) / propagation_speed
    return now - delay[..., None] * mean[..., 2:KINEMATIC], delay


def doppler(
    velocity: FloatArray,
    relative: FloatArray,
    direction: FloatArray,
    distance: FloatArray,
    speeds: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """Return what source frequencies are multiplied by, and its derivatives.

    Parameters
    ----------
    velocity, relative : ndarray, shape (..., 2)
        Of the target in the water, and relative to the sensor, m/s.
    direction : ndarray, shape (..., 2)
        Unit vector to where the target is seen.
    distance : ndarray, shape (...)
        To there, m.
    speeds : tuple of float
        Speed of sound, and that at which it propagates, inf = seen at once, m/s.

    Returns
    -------
    factor : ndarray, shape (...)
        Pure numbers.
    gradient : ndarray, shape (..., 4)
        By where the target is seen and by its velocity, 1/m and s/m.
    """
    rate = _along(direction, relative)
    across = (relative - rate[..., None] * direction) / distance[..., None]
    gradient = np.concatenate([across, direction], axis=-1)
    if np.isfinite(speeds[1]):
        own = _along(direction, velocity)
        speed = speeds[0] + own
        beside = (velocity - own[..., None] * direction) / distance[..., None]
        share = rate / speed
        gradient -= share[..., None] * np.concatenate([beside, direction], axis=-1)
        return np.asarray(1.0 - share), gradient / -speed[..., None]
    return np.asarray(1.0 - rate / speeds[0]), gradient / -speeds[0]


def refer_to_now(
    derivative: FloatArray,
    velocity: FloatArray,
    direction: FloatArray,
    delay: FloatArray,
    propagation_speed: float,
) -> None:
    """Refer derivatives by where a target is seen to where it is now, in place.

    Parameters
    ----------
    derivative : ndarray, shape (..., n_rows, at least 4)
        By the place at which it is seen and by the velocity, then anything; units over m and m/s.
    velocity : ndarray, shape (..., 2)
        Of the target, m/s.
    direction : ndarray, shape (..., 2)
        Unit vector to where it is seen.
    delay : ndarray, shape (...)
        How long ago it was there, s.
    propagation_speed : float
        m/s; inf = seen at once.
    """
    if np.isfinite(propagation_speed):
        speed = (propagation_speed + _along(direction, velocity))[..., None]
        x, y = derivative[..., 0], derivative[..., 1]
        moved = (x * velocity[..., None, 0] + y * velocity[..., None, 1]) / speed
        x -= moved * direction[..., None, 0]
        y -= moved * direction[..., None, 1]
    derivative[..., 2:KINEMATIC] -= derivative[..., :2] * delay[..., None, None]


def _along(direction: FloatArray, velocity: FloatArray) -> FloatArray:
    """Return the scalar product of vectors in the plane: a sum over an axis takes longer."""
    return np.asarray(direction[..., 0] * velocity[..., 0] + direction[..., 1] * velocity[..., 1])
