"""What a moving sensor measures of a moving source: azimuth, elevation, received frequencies.

With p and w the target's position and velocity relative to the sensor, r = |p|, u = p / r:

    azimuth = atan2(p_y, p_x),   elevation = atan((z - z_sensor) / r),
    f_i = f_S,i (1 - rdot / c),  rdot = p . w / r.

Sound takes time: what is received now left the target a travel time ago, when it was elsewhere.
With a finite propagation speed p is that earlier position, the state always is that of the stamp,
and rdot is divided by c + v . p / r, v being the target's velocity in the water.

The paper divides the range rate by the absolute position, which is wrong as soon as the sensor
moves, and prints arctan(x / y) where atan2 is needed. ``compiled_rows``, which is there if a
compiler was when the package was installed, gives the bits of what is here in numpy.

References
----------
Cheong (2011), eqs. 6-13, with those two corrections.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.sensor_frame import (
    DEVIATION,
    KINEMATIC,
    VERTICAL,
    TmaMeasurement,
)
from sonar_tracking.tma.estimators.travel_time import doppler, offset_seen, refer_to_now

COMPILED = compiled_module("tma.estimators.compiled_rows")

AZIMUTH, ELEVATION, FIRST_LINE = 0, 1, 2
"""Rows of a measurement."""

RELATED = 7
"""Numbers of a state seen from the sensor, compiled: offsets, height, velocity, travel time."""

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
    """Return which rows have errors that are watched, shape (1 + n_lines,): not the elevation."""
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
    return _doppler(mean, measurement, *_relative(mean, measurement)[:3])[0]


def linearise(
    mean: FloatArray,
    measurement: TmaMeasurement,
    known: BoolArray,
    azimuth: FloatArray | None = None,
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
    azimuth : ndarray, shape (..., n_components) or (..., 1), optional
        The measured azimuth as each component takes it, rad; if not given the one of those of the
        measurement that is nearest to what the component expects.
    """
    if COMPILED is not None and azimuth is None:
        return _compiled_rows(COMPILED, mean, measurement, known)
    return _plain_rows(mean, measurement, known, azimuth)


def _plain_rows(
    mean: FloatArray, measurement: TmaMeasurement, known: BoolArray, azimuth: FloatArray | None
) -> LinearisedRows:
    """Return the rows, each component with the azimuth given, or with the nearest."""
    distance, direction, relative, delay = _relative(mean, measurement)
    n_lines = known.shape[-1]
    shape = (*mean.shape[:-1], 2 + n_lines)
    innovation, variance = np.zeros(shape), np.ones(shape)
    present = np.zeros(shape, dtype=bool)
    vertical = has_height(mean, n_lines)
    derivative = np.zeros((*shape, KINEMATIC + n_lines + VERTICAL * vertical))

    x, y = direction[..., 0], direction[..., 1]
    expected = np.arctan2(y, x)
    azimuth = _nearest(measurement.azimuth, expected) if azimuth is None else azimuth
    innovation[..., 0] = wrap_angle(azimuth - expected)
    derivative[..., 0, 0], derivative[..., 0, 1] = -y / distance, x / distance
    variance[..., 0] = measurement.azimuth_variance[..., None]

    place = KINEMATIC + n_lines
    height: FloatArray | float = measurement.height
    if vertical:
        height = mean[..., place] - delay * mean[..., place + 1] - measurement.sensor_z
    innovation[..., 1] = measurement.elevation[..., None] - np.arctan2(height, distance)
    slant = distance * distance + height * height
    slope = -height / slant
    derivative[..., 1, :2] = slope[..., None] * direction
    if vertical:
        rise = distance / slant
        derivative[..., 1, place], derivative[..., 1, place + 1] = rise, -delay * rise
    variance[..., 1] = measurement.elevation_variance[..., None]
    if n_lines:
        factor, gradient = _doppler(mean, measurement, distance, direction, relative)
        source = mean[..., KINEMATIC:place]
        innovation[..., 2:] = measurement.frequency[..., None, :] - source * factor[..., None]
        derivative[..., 2:, :KINEMATIC] = source[..., None] * gradient[..., None, :]
        lines = np.arange(n_lines)
        derivative[..., 2 + lines, KINEMATIC + lines] = factor[..., None]
        variance[..., 2:] = measurement.frequency_deviation[..., None, :] ** 2
        present[..., 2:] = known[..., None, :]
    velocity = mean[..., 2:KINEMATIC]
    refer_to_now(derivative, velocity, direction, delay, measurement.propagation_speed)
    present[..., :2] = True
    present &= np.isfinite(innovation) & np.isfinite(variance)
    return keep_rows(LinearisedRows(innovation, derivative, variance, present), present)


def _compiled_rows(
    compiled: ModuleType, mean: FloatArray, measurement: TmaMeasurement, known: BoolArray
) -> LinearisedRows:
    """Return the rows, each component with the nearest azimuth."""
    batch, n_lines, seen = mean.shape[:-2], known.shape[-1], measurement
    vertical = has_height(mean, n_lines)
    entries, states = math.prod(batch), np.ascontiguousarray(mean, dtype=float)
    shape = (entries, *mean.shape[-2:], n_lines, int(vertical))
    speeds = float(seen.sound_speed), float(seen.propagation_speed)
    constants = (*speeds, float(seen.height), float(seen.sensor_z), MINIMUM_RANGE)
    related = np.empty((RELATED, entries * mean.shape[-2]))
    position, velocity = _column(seen.position, batch, 2), _column(seen.velocity, batch, 2)
    compiled.relate(states, position, velocity, related, constants, shape)
    angles = np.arctan2(related[:2], related[2:4])
    rows = (*mean.shape[:-1], FIRST_LINE + n_lines)
    found = LinearisedRows(
        np.empty(rows),
        np.empty((*rows, KINEMATIC + n_lines + VERTICAL * vertical)),
        np.empty(rows),
        np.empty(rows, dtype=bool),
    )
    n_sides = seen.azimuth.shape[-1]
    columns = (
        *(_column(seen.azimuth, batch, n_sides), _column(seen.azimuth_variance, batch)),
        *(_column(seen.elevation, batch), _column(seen.elevation_variance, batch)),
        *(
            _column(seen.frequency, batch, n_lines),
            _column(seen.frequency_deviation, batch, n_lines),
        ),
    )
    out = found.innovation, found.derivative, found.variance, found.present
    heard = np.ascontiguousarray(np.broadcast_to(known, (*batch, n_lines)))
    compiled.linearise(*(states, related, angles, heard, *columns, *out), constants, shape, n_sides)
    return found


def _column(values: FloatArray, batch: tuple[int, ...], *width: int) -> FloatArray:
    """Return values of each entry of a batch one after the other, or one for all."""
    if values.shape not in (width, (*batch, *width)):
        values = np.broadcast_to(values, (*batch, *width))
    return np.ascontiguousarray(values, dtype=float)


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


def _nearest(azimuth: FloatArray, expected: FloatArray) -> FloatArray:
    """Return the azimuth that is nearest to what each component expects."""
    if azimuth.shape[-1] == 1:
        return azimuth
    apart = wrap_angle(azimuth[..., None, :] - expected[..., None])
    candidates = np.broadcast_to(azimuth[..., None, :], apart.shape)
    nearest = np.argmin(np.abs(apart), axis=-1)[..., None]
    return np.asarray(np.take_along_axis(candidates, nearest, axis=-1)[..., 0])


def _doppler(
    mean: FloatArray,
    measurement: TmaMeasurement,
    distance: FloatArray,
    direction: FloatArray,
    relative: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the Doppler factor and its derivatives by where it is seen and by the velocity."""
    speeds = measurement.sound_speed, measurement.propagation_speed
    return doppler(mean[..., 2:KINEMATIC], relative, direction, distance, speeds)


def _relative(
    mean: FloatArray, measurement: TmaMeasurement
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return range, unit vector towards the target, relative velocity and travel time."""
    position = measurement.position[..., None, :]
    offset, delay = offset_seen(mean, position, measurement.propagation_speed)
    distance = np.maximum(np.hypot(offset[..., 0], offset[..., 1]), MINIMUM_RANGE)
    relative = mean[..., 2:KINEMATIC] - measurement.velocity[..., None, :]
    return distance, offset / distance[..., None], relative, delay
