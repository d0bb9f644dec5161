"""Stacked dots: what a solution leaves of everything that was measured of its target.

The state of a track is carried back along a straight course to each instant at which one of its
sensors measured something, and the residual is measured minus predicted: the angle of each bearing
and the frequency of each line. A right solution stacks the dots along zero within their deviations.
A wrong range or speed bends them, most of all where own ship turned, which is why her legs belong
behind them; a target that turned leaves the column before its turn.

With p the vector from the sensor, when it heard, to the target, when the sound left it, r = |p|,
u = p / r, the velocities v of the target and w of the sensor, and psi the azimuth of the array:

    cone angle  theta = asin(cos psi u_x + sin psi u_y),    azimuth  atan2(u_y, u_x) (- psi),
    frequency   f = f_S (1 - u . (v - w) / (c + u . v)).

References
----------
Aidala (1979), Kalman filter behavior in bearings-only tracking applications (residuals of a
manually adjusted target estimate).
Cheong (2011), eqs. 6-13, for the received frequency.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.time import seconds

SOUND_SPEED = 1500.0
"""In the water, m/s."""

LARGEST_SHIFT = 0.05
"""A line farther from its prediction, as a share of the frequency, is another one."""


@dataclass(frozen=True)
class Hearing:
    """When and where a sensor measured one target, row by row.

    Attributes
    ----------
    stamps : ndarray of int, shape (n,)
        ns, ascending.
    position, velocity : ndarray, shape (n, 2)
        Of the sensor in ``map``, m and m/s.
    axis_azimuth : ndarray, shape (n,)
        Of +x of the sensor in ``map``, rad.
    value, deviation : ndarray, shape (n,)
        Angle in rad, or frequency in Hz, and its standard deviation.
    cone : bool
        Whether angles are cone angles rather than azimuths from +x of the sensor.
    """

    stamps: IntArray
    position: FloatArray
    velocity: FloatArray
    axis_azimuth: FloatArray
    value: FloatArray
    deviation: FloatArray
    cone: bool = True


@dataclass(frozen=True)
class DotStack:
    """Residuals against time.

    Attributes
    ----------
    label : str
        Sensor and what it measured.
    stamps : ndarray of int, shape (n,)
        ns.
    residual, deviation : ndarray, shape (n,)
        Measured minus predicted and the standard deviation of the measurement, rad or Hz.
    frequency : float
        Of the line at rest, Hz; NaN = bearings.
    """

    label: str
    stamps: IntArray
    residual: FloatArray
    deviation: FloatArray
    frequency: float = field(default=np.nan)


def bearing_dots(state: FloatArray, stamp: int, heard: Hearing, label: str) -> DotStack:
    """Return the residuals of bearings.

    Parameters
    ----------
    state : ndarray, shape (4,)
        x, y, vx, vy of the solution at its stamp, m and m/s.
    stamp : int
        ns.
    heard : Hearing
        Angles.
    label : str
        Of the stack.
    """
    direction, _ = _sight(state, stamp, heard)
    azimuth = np.arctan2(direction[:, 1], direction[:, 0]) - heard.axis_azimuth
    if heard.cone:
        residual = np.arcsin(np.sin(heard.value)) - np.arcsin(np.clip(np.cos(azimuth), -1.0, 1.0))
    else:
        residual = wrap_angle(heard.value - azimuth)
    return DotStack(label, heard.stamps, residual, heard.deviation)


def frequency_dots(
    state: FloatArray, stamp: int, source_frequency: float, heard: Hearing, label: str
) -> DotStack:
    """Return the residuals of a line.

    Where its frequency at rest is not known, the one that fits most dots is taken: the shape of the
    column tells as much then, its place nothing.

    Parameters
    ----------
    state : ndarray, shape (4,)
        x, y, vx, vy of the solution at its stamp, m and m/s.
    stamp : int
        ns.
    source_frequency : float
        Of the line at rest, Hz; NaN = not known.
    heard : Hearing
        Received frequencies; those far from the line are of another one, and left out.
    label : str
        Of the stack.
    """
    direction, velocity = _sight(state, stamp, heard)
    rate = np.sum(direction * (velocity - heard.velocity), axis=1)
    away = np.sum(direction * velocity, axis=1)
    factor = 1.0 - rate / (SOUND_SPEED + away)
    if not np.isfinite(source_frequency):
        source_frequency = float(np.median(heard.value / factor))
    predicted = source_frequency * factor
    near: BoolArray = np.abs(heard.value - predicted) <= LARGEST_SHIFT * source_frequency
    return DotStack(
        label,
        heard.stamps[near],
        (heard.value - predicted)[near],
        heard.deviation[near],
        source_frequency,
    )


def _sight(state: FloatArray, stamp: int, heard: Hearing) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors from sensor to target, and the target's velocity, shapes (n, 2)."""
    elapsed = seconds(heard.stamps - stamp)
    velocity = np.broadcast_to(state[2:4], (len(elapsed), 2))
    now = state[:2] + elapsed[:, None] * velocity - heard.position
    delay = np.hypot(now[:, 0], now[:, 1]) / SOUND_SPEED
    for _ in range(2):  # each step leaves an error smaller by the ratio of speeds
        then = now - delay[:, None] * velocity
        delay = np.hypot(then[:, 0], then[:, 1]) / SOUND_SPEED
    then = now - delay[:, None] * velocity
    distance = np.maximum(np.hypot(then[:, 0], then[:, 1]), 1.0)
    return then / distance[:, None], velocity
