"""What a moving sensor measures of a moving source: azimuth, elevation, received frequencies.

With p and w the target's position and velocity relative to the sensor, r = |p|, u = p / r:

    azimuth = atan2(p_y, p_x),   elevation = atan((z - z_sensor) / r),
    f_i = f_S,i (1 - rdot / c),  rdot = p . w / r.

Sound takes time: what is received now left the target a travel time ago, when it was elsewhere.
With a finite propagation speed p is that earlier position, the state always is that of the stamp,
and rdot is divided by c + v . p / r, v being the target's velocity in the water.

The paper divides the range rate by the absolute position, which is wrong as soon as the sensor
moves, and prints arctan(x / y) where atan2 is needed.

References
----------
Cheong (2011), eqs. 6-13, with those two corrections.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.sensor_frame import (
    DEVIATION,
    KINEMATIC,
    VERTICAL,
    TmaMeasurement,
)

AZIMUTH, ELEVATION, FIRST_LINE = 0, 1, 2
"""Rows of a measurement."""

MINIMUM_RANGE = 1.0
"""Below it directions are numerically meaningless; ranges are kept above, m."""


@dataclass(frozen=True)
class LinearisedRows:
    """Measurement rows at one state: azimuth, elevation, then one a line.

    Rows that are not there have innovation 0, derivative 0 and variance 1, so that they change
    nothing in an update and nothing need be cut out.

    Attributes
    ----------
    innovation : ndarray, shape (..., n_rows)
        Measured minus predicted, rad (wrapped) and Hz.
    derivative : ndarray, shape (..., n_rows, 4 + n_lines) or two more
        Of the prediction, by the motion, the source frequencies and the height, if that is
        estimated: rad and Hz over their units.
    variance : ndarray, shape (..., n_rows)
        Of the measurement, rad^2 and Hz^2.
    present : ndarray of bool, shape (..., n_rows)
        Which rows are there.
    """

    innovation: FloatArray
    derivative: FloatArray
    variance: FloatArray
    present: BoolArray


def watched_rows(rows: LinearisedRows) -> IntArray:
    """Return the places of those whose errors are watched: azimuth and lines, not the elevation."""
    return _watched(rows.variance.shape[-1])


@lru_cache(maxsize=64)
def _watched(n_rows: int) -> IntArray:
    return np.delete(np.arange(n_rows), ELEVATION)


def has_height(mean: FloatArray, n_lines: int) -> bool:
    """Return whether states of so many lines have a height behind the lines.

    Parameters
    ----------
    mean : ndarray, shape (..., n)
        States, m, m/s and Hz.
    n_lines : int
        Lines in them.
    """
    return (mean.shape[-1] - KINEMATIC - n_lines) % DEVIATION == VERTICAL


def range_rate(mean: FloatArray, measurement: TmaMeasurement) -> FloatArray:
    """Return the range rate seen by the sensor.

    Parameters
    ----------
    mean : ndarray, shape (..., n_components, at least 4)
        States x, y, vx, vy, m and m/s.
    measurement : TmaMeasurement
        Whose sensor.

    Returns
    -------
    ndarray, shape (..., n_components)
        m/s, positive when the range grows.
    """
    _, direction, relative, _ = _relative(mean, measurement)
    return np.sum(direction * relative, axis=-1)


def doppler_factor(mean: FloatArray, measurement: TmaMeasurement) -> FloatArray:
    """Return what a source frequency is multiplied by on its way to the sensor.

    Parameters
    ----------
    mean : ndarray, shape (..., n_components, at least 4)
        States x, y, vx, vy, m and m/s.
    measurement : TmaMeasurement
        Whose sensor.

    Returns
    -------
    ndarray, shape (..., n_components)
        Pure numbers.
    """
    _, direction, relative, _ = _relative(mean, measurement)
    return _factor(mean, direction, relative, measurement)


def linearise(
    mean: FloatArray, measurement: TmaMeasurement, known: BoolArray, azimuth: FloatArray
) -> LinearisedRows:
    """Return innovations and derivatives of all rows at the given states.

    Parameters
    ----------
    mean : ndarray, shape (..., n_components, at least 4 + n_lines)
        States to linearise at, m, m/s and Hz; no row depends on a deviation from a mean course,
        which comes behind all else.
    measurement : TmaMeasurement
        What was measured.
    known : ndarray of bool, shape (..., n_lines)
        Lines that have a source frequency in the state; the rows of others are not there.
    azimuth : ndarray, shape (..., n_components) or (..., 1)
        The measured azimuth as each component takes it, rad.
    """
    distance, direction, relative, delay = _relative(mean, measurement)
    n_lines = known.shape[-1]
    shape = (*mean.shape[:-1], 2 + n_lines)
    innovation, variance = np.zeros(shape), np.ones(shape)
    present = np.zeros(shape, dtype=bool)
    vertical = has_height(mean, n_lines)
    derivative = np.zeros((*shape, KINEMATIC + n_lines + VERTICAL * vertical))

    x, y = direction[..., 0], direction[..., 1]
    innovation[..., 0] = wrap_angle(azimuth - np.arctan2(y, x))
    derivative[..., 0, 0], derivative[..., 0, 1] = -y / distance, x / distance
    variance[..., 0] = measurement.azimuth_variance[..., None]

    place = KINEMATIC + n_lines
    height: FloatArray | float = measurement.height
    if vertical:
        height = mean[..., place] - delay * mean[..., place + 1] - measurement.sensor_z
    innovation[..., 1] = measurement.elevation[..., None] - np.arctan2(height, distance)
    slope = -height / (distance**2 + height**2)
    derivative[..., 1, :2] = slope[..., None] * direction
    if vertical:
        rise = distance / (distance**2 + height**2)
        derivative[..., 1, place], derivative[..., 1, place + 1] = rise, -delay * rise
    variance[..., 1] = measurement.elevation_variance[..., None]
    if n_lines:
        rate = np.sum(direction * relative, axis=-1)
        factor = _factor(mean, direction, relative, measurement)
        source = mean[..., KINEMATIC:place]
        innovation[..., 2:] = measurement.frequency[..., None, :] - source * factor[..., None]
        across = (relative - rate[..., None] * direction) / distance[..., None]
        gradient = np.concatenate([across, direction], axis=-1) / -measurement.sound_speed
        derivative[..., 2:, :KINEMATIC] = source[..., None] * gradient[..., None, :]
        lines = np.arange(n_lines)
        derivative[..., 2 + lines, KINEMATIC + lines] = factor[..., None]
        variance[..., 2:] = measurement.frequency_deviation[..., None, :] ** 2
        present[..., 2:] = known[..., None, :]
    earlier = derivative[..., :2] * delay[..., None, None]
    derivative[..., 2:KINEMATIC] -= earlier
    present[..., :2] = True
    present &= np.isfinite(innovation) & np.isfinite(variance)
    return keep_rows(LinearisedRows(innovation, derivative, variance, present), present)


def keep_rows(rows: LinearisedRows, keep: BoolArray) -> LinearisedRows:
    """Return the rows with those that are not kept made ineffective.

    Parameters
    ----------
    rows : LinearisedRows
        All rows.
    keep : ndarray of bool, shape (..., n_rows)
        Which to keep.
    """
    return LinearisedRows(
        np.where(keep, rows.innovation, 0.0),
        np.where(keep[..., None], rows.derivative, 0.0),
        np.where(keep, rows.variance, 1.0),
        keep,
    )


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


def _factor(
    mean: FloatArray, direction: FloatArray, relative: FloatArray, measurement: TmaMeasurement
) -> FloatArray:
    """Return the Doppler factor: with travel time exactly, sound being left behind by its source.

    To first order in v / c both are the same; lines good to 1e-5 tell them apart.
    """
    speed = measurement.sound_speed
    rate = np.sum(direction * relative, axis=-1)
    if np.isfinite(measurement.propagation_speed):
        speed = speed + np.sum(direction * mean[..., 2:KINEMATIC], axis=-1)
    return np.asarray(1.0 - rate / speed)


def _relative(
    mean: FloatArray, measurement: TmaMeasurement
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return range, unit vector towards the target, relative velocity and travel time."""
    position = measurement.position[..., None, :]
    offset, delay = offset_seen(mean, position, measurement.propagation_speed)
    distance = np.maximum(np.hypot(offset[..., 0], offset[..., 1]), MINIMUM_RANGE)
    relative = mean[..., 2:KINEMATIC] - measurement.velocity[..., None, :]
    return distance, offset / distance[..., None], relative, delay
