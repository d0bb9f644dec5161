"""The last measurements of one target, as arrays: what its observability is judged by."""

from __future__ import annotations

import copy
from dataclasses import replace
from math import isfinite

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import seconds
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration
from sonar_tracking.tma.targets.observability import (
    AZIMUTH,
    ELEVATION,
    HEIGHT,
    LINES,
    POSITION,
    TIME,
    VELOCITY,
    MeasurementHistory,
    observability,
    root_of,
)

LOG_FRAMES = 1000
"""Measurements kept; the first one, where the prior stands, is kept for ever."""

UNREAD_FRAMES = 256
"""So many are kept as they came at most, until someone asks: most trials end sooner."""


class MeasurementLog:
    """Log of the measurements of a single run.

    Parameters
    ----------
    first : TmaMeasurement
        The one that made the prior; it is appended like all others.
    maximum_range, maximum_speed : float
        Of the prior, m and m/s.
    """

    def __init__(self, first: TmaMeasurement, maximum_range: float, maximum_speed: float) -> None:
        configuration = SingleFilterConfiguration(maximum_range, maximum_speed)
        self._roots = [
            root_of(_prior(configuration, replace(first, azimuth=first.azimuth[side : side + 1])))
            for side in range(len(first.azimuth))
        ]
        self._first_stamp = first.stamp
        self._sound_speed = first.sound_speed
        self._count = 0
        self._table = np.zeros((64, LINES + first.n_lines))
        self._newest: list[TmaMeasurement] = []

    def append(self, measurement: TmaMeasurement) -> None:
        """Log a measurement; it may have more columns of lines than those before."""
        self._newest.append(measurement)
        if len(self._newest) == UNREAD_FRAMES:
            self._write_newest()

    def _write_newest(self) -> None:
        """Bring the table up to date: many logs are never read."""
        for measurement in self._newest:
            self._write(measurement)
        self._newest = []

    def _write(self, measurement: TmaMeasurement) -> None:
        n_lines = measurement.n_lines
        added = LINES + n_lines - self._table.shape[1]
        if self._count == len(self._table) and self._count < LOG_FRAMES:
            grown = min(LOG_FRAMES, 2 * self._count) - self._count
            self._table = np.pad(self._table, ((0, grown), (0, max(added, 0))))
        elif added > 0:
            self._table = np.pad(self._table, ((0, 0), (0, added)))
        if self._count == len(self._table):
            self._table[1:-1] = self._table[2:].copy()
            self._count -= 1
        row = self._table[self._count]
        row[:] = 0.0
        row[TIME] = seconds(measurement.stamp - self._first_stamp)
        row[POSITION], row[VELOCITY] = measurement.position, measurement.velocity
        row[AZIMUTH] = _information_of(measurement.azimuth[0], measurement.azimuth_variance)
        if measurement.height_deviation == 0.0:
            row[ELEVATION] = _information_of(measurement.elevation, measurement.elevation_variance)
        row[HEIGHT] = measurement.height
        if n_lines:
            variance = measurement.frequency_deviation**2
            row[LINES : LINES + n_lines] = _information(measurement.frequency, variance)
        self._count += 1
        self._sound_speed = measurement.sound_speed

    def copy(self) -> MeasurementLog:
        """Return a log that goes on from here independently."""
        copied = copy.copy(self)
        copied._table = self._table.copy()
        copied._newest = list(self._newest)
        return copied

    def forget_lines(self, columns: tuple[int, ...]) -> None:
        """Blank the columns of lines that are forgotten."""
        self._write_newest()
        for column in columns:
            self._table[:, LINES + column] = 0.0

    def observability(self, mean: FloatArray, side: int = 0) -> float:
        """Return the observability figure of an estimate, 0 to 1.

        Parameters
        ----------
        mean : ndarray, shape (4 + n_lines,)
            Motion at the last logged measurement, then the source frequencies, m, m/s
            and Hz.
        side : int
            Which of the first azimuths the estimate goes back to; the last one if there are fewer.
        """
        root = self._roots[min(side, len(self._roots) - 1)]
        return observability(mean[:KINEMATIC], mean[KINEMATIC:], self.history(), root)

    def history(self) -> MeasurementHistory:
        """Return what was logged, in order."""
        self._write_newest()
        return MeasurementHistory(self._table[: self._count], self._sound_speed)


def _prior(configuration: SingleFilterConfiguration, first: TmaMeasurement) -> FloatArray:
    """Return the covariance of the motion at the first measurement, from one of its sides."""
    return configuration.start(first).covariance[0, :KINEMATIC, :KINEMATIC]


def _information_of(value: FloatArray, variance: FloatArray) -> float:
    spread = float(variance)
    return 1.0 / spread if isfinite(value) and isfinite(spread) else 0.0


def _information(value: FloatArray, variance: FloatArray) -> FloatArray:
    known = np.isfinite(value) & np.isfinite(variance)
    return np.where(known, 1.0 / np.where(known, variance, 1.0), 0.0)
