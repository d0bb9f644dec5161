"""All that was measured of one target, and what a measurement says at a given path.

Rows of an instant are an azimuth, an elevation and one a line. With p the target's position seen
from the station, where it was when the sound left, u = p / |p| and w the relative velocity,

    azimuth = atan2(p_y, p_x) + b / cos(elevation),   elevation = atan(height / |p|) + b',
    f_i = f_S,i (1 - u . w / (c + u . v)),

b and b' being errors of the station's directions that last: each the sum of a constant and a
faster one, and v the target's velocity; where sound takes no time, c alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC
from sonar_tracking.tma.estimators.travel_time import doppler, offset_seen, refer_to_now

AZIMUTH, ELEVATION, LINES = 0, 1, 2
"""Rows of an instant: lines are the last ones."""

MINIMUM_RANGE, MINIMUM_COSINE = 1.0, 0.05
"""Overhead an azimuth says nothing; m, and cosine of the elevation."""


@dataclass(frozen=True)
class TargetHistory:
    """Measurements of one target in order of time, of one station or of several.

    Attributes
    ----------
    times : ndarray, shape (n,)
        s, ascending; several stations may have measured at one time.
    station : ndarray of int, shape (n,)
        Who measured, 0 to n_stations - 1.
    position, velocity : ndarray, shape (n, 2)
        Of the station, m and m/s.
    azimuth : ndarray, shape (n, 2)
        rad: the two a line array cannot tell apart, or one and NaN; NaN = none.
    azimuth_deviation : ndarray, shape (n,)
        rad; NaN = none.
    elevation, elevation_deviation : ndarray, shape (n,)
        rad; NaN = none.
    height : float
        Known height of the target above the stations, m.
    frequency, frequency_deviation : ndarray, shape (n, n_lines)
        Received, Hz; NaN = the line is absent.
    sound_speed, propagation_speed : float
        m/s; the second inf = seen at once.
    bending : float
        Relative difference of the speed of sound along the path, which bends rays: a pure number.
    """

    times: FloatArray
    station: IntArray
    position: FloatArray
    velocity: FloatArray
    azimuth: FloatArray
    azimuth_deviation: FloatArray
    elevation: FloatArray
    elevation_deviation: FloatArray
    height: float
    frequency: FloatArray
    frequency_deviation: FloatArray
    sound_speed: float = 1500.0
    propagation_speed: float = np.inf
    bending: float = 0.0

    @property
    def n_lines(self) -> int:
        """Columns of lines."""
        return self.frequency.shape[1]

    @cached_property
    def n_stations(self) -> int:
        """Stations that measured."""
        return int(self.station.max(initial=0)) + 1

    @cached_property
    def n_errors(self) -> int:
        """Errors that last, of one kind: one a station, two if elevations were measured."""
        return self.n_stations * (2 if np.isfinite(self.elevation).any() else 1)

    @cached_property
    def slow(self) -> IntArray:
        """Columns of constant errors in the state, shape (n_errors,): azimuths, then elevations."""
        return KINEMATIC + np.arange(self.n_errors)

    @cached_property
    def fast(self) -> IntArray:
        """Columns of the faster errors in the state, shape (n_errors,), in the same order."""
        return KINEMATIC + self.n_errors + np.arange(self.n_errors)

    @cached_property
    def lines(self) -> IntArray:
        """Columns of the source frequencies in the state, shape (n_lines,)."""
        return KINEMATIC + 2 * self.n_errors + np.arange(self.n_lines)

    @property
    def size(self) -> int:
        """Length of the state: motion, lasting errors, source frequencies."""
        return KINEMATIC + 2 * self.n_errors + self.n_lines

    @cached_property
    def deviations(self) -> FloatArray:
        """Standard deviation of every row, shape (n, 2 + n_lines), rad and Hz."""
        directions = np.stack([self.azimuth_deviation, self.elevation_deviation], axis=1)
        return np.concatenate([directions, self.frequency_deviation], axis=1)

    @cached_property
    def groups(self) -> IntArray:
        """A number for each row, shape (n, 2 + n_lines): one a kind of error.

        Azimuths of each station, elevations of each station, each line.
        """
        directions = np.stack([self.station, self.n_stations + self.station], axis=1)
        lines = 2 * self.n_stations + np.arange(self.n_lines)
        return np.concatenate(
            [directions, np.broadcast_to(lines, (len(self.times), self.n_lines))], axis=1
        )


@dataclass(frozen=True)
class HistoryRows:
    """All rows at a path.

    Attributes
    ----------
    residual : ndarray, shape (n, 2 + n_lines)
        Measured minus predicted, rad (wrapped) and Hz; 0 where there is nothing.
    derivative : ndarray, shape (n, 2 + n_lines, size)
        Of the prediction, by the state, rad and Hz over units of the state; 0 where there is
        nothing.
    present : ndarray of bool, shape (n, 2 + n_lines)
        Which rows there are.
    """

    residual: FloatArray
    derivative: FloatArray
    present: BoolArray


def rows_at(history: TargetHistory, path: FloatArray) -> HistoryRows:
    """Return residuals and derivatives of all rows.

    Parameters
    ----------
    history : TargetHistory
        What was measured.
    path : ndarray, shape (n, size)
        States: x, y, vx, vy, errors that last, source frequencies; m, m/s, rad, Hz.
    """
    n_times, n_lines = len(history.times), history.n_lines
    offset, delay = offset_seen(path, history.position, history.propagation_speed)
    distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), MINIMUM_RANGE)
    direction = offset / distance[:, None]
    relative = path[:, 2:KINEMATIC] - history.velocity
    residual = np.empty((n_times, LINES + n_lines))
    derivative = np.zeros((*residual.shape, history.size))

    instants = np.arange(n_times)
    lasting = path[:, history.slow] + path[:, history.fast]
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    elevation = np.arctan2(history.height, distance)
    cosine = np.maximum(np.cos(elevation), MINIMUM_COSINE)
    error = lasting[instants, history.station] / cosine
    both = wrap_angle(history.azimuth - (np.arctan2(offset[:, 1], offset[:, 0]) + error)[:, None])
    nearest = np.argmin(np.where(np.isfinite(both), np.abs(both), np.inf), axis=1)
    residual[:, AZIMUTH] = both[instants, nearest]
    derivative[:, AZIMUTH, :2] = normal / distance[:, None]
    for columns in (history.slow, history.fast):
        derivative[instants, AZIMUTH, columns[history.station]] = 1.0 / cosine

    residual[:, ELEVATION] = history.elevation - elevation
    slope = -history.height / (distance**2 + history.height**2)
    derivative[:, ELEVATION, :2] = slope[:, None] * direction
    if history.n_errors > history.n_stations:
        own = history.n_stations + history.station
        residual[:, ELEVATION] -= lasting[instants, own]
        for columns in (history.slow, history.fast):
            derivative[instants, ELEVATION, columns[own]] = 1.0

    if n_lines:
        speeds = history.sound_speed, history.propagation_speed
        factor, gradient = doppler(path[:, 2:KINEMATIC], relative, direction, distance, speeds)
        source = path[:, history.lines]
        residual[:, LINES:] = history.frequency - source * factor[:, None]
        derivative[:, LINES:, :KINEMATIC] = source[:, :, None] * gradient[:, None, :]
        derivative[:, LINES + np.arange(n_lines), history.lines] = factor[:, None]
    refer_to_now(derivative, path[:, 2:KINEMATIC], direction, delay, history.propagation_speed)
    present = np.isfinite(residual) & np.isfinite(history.deviations)
    return HistoryRows(
        np.where(present, residual, 0.0), np.where(present[..., None], derivative, 0.0), present
    )
