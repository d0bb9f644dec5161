"""What flows through target motion analysis: one sensor's frame in, one solution out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray

KINEMATIC = 4
"""Length of the kinematic state [x, y, vx, vy]."""

VERTICAL = 2
"""Length of the vertical state [z, vz], which follows the lines where the height is estimated."""

DEVIATION = 4
"""Length of the deviation from a mean course: its x and y, and their rates; the last states."""


def _none() -> FloatArray:
    return np.array(np.nan)


def _no_lines() -> FloatArray:
    return np.empty(0)


@dataclass(frozen=True)
class TmaMeasurement:
    """What one sensor measured of one target at one instant.

    Attributes
    ----------
    stamp : int
        Instant, ns.
    position, velocity : ndarray, shape (..., 2)
        Of the sensor in ``map``, m and m/s.
    azimuth : ndarray, shape (..., n_sides)
        rad; one value, or the two a line array cannot tell apart (left, right). NaN = none.
    azimuth_variance : ndarray, shape (...)
        rad^2.
    frequency, frequency_deviation : ndarray, shape (..., n_lines)
        Received frequencies and their standard deviations, Hz; a line keeps its column. NaN = the
        line is absent.
    elevation, elevation_variance : ndarray, shape (...)
        Above the horizontal, rad and rad^2. NaN = none.
    height, height_deviation : float
        Height of the target above the sensor and its standard deviation, m, before elevations are
        taken in; 0 = it is known. Used with elevations only.
    sensor_z : float
        Height of the sensor in ``map``, m.
    sound_speed : float
        m/s.
    propagation_speed : float
        At which the sound travels, m/s: it tells where the target was when it left. inf = where it
        is now, as in the paper.
    """

    stamp: int
    position: FloatArray
    velocity: FloatArray
    azimuth: FloatArray
    azimuth_variance: FloatArray
    frequency: FloatArray = field(default_factory=_no_lines)
    frequency_deviation: FloatArray = field(default_factory=_no_lines)
    elevation: FloatArray = field(default_factory=_none)
    elevation_variance: FloatArray = field(default_factory=_none)
    height: float = 0.0
    height_deviation: float = 0.0
    sensor_z: float = 0.0
    sound_speed: float = 1500.0
    propagation_speed: float = np.inf

    @property
    def n_lines(self) -> int:
        """Columns of lines."""
        return self.frequency.shape[-1]

    @property
    def estimates_height(self) -> bool:
        """Whether it tells of a height that is not known."""
        return self.height_deviation > 0.0 and bool(np.isfinite(self.elevation).any())

    @property
    def heard(self) -> BoolArray:
        """Which lines are present, shape (..., n_lines)."""
        return np.isfinite(self.frequency) & np.isfinite(self.frequency_deviation)


@dataclass(frozen=True)
class TmaEstimate:
    """Where the target is and how it moves.

    Attributes
    ----------
    stamp : int
        Instant, ns.
    mean : ndarray, shape (..., 4)
        x, y, vx, vy in ``map``, m and m/s.
    covariance : ndarray, shape (..., 4, 4)
        Of the mean, m^2, m^2/s, m^2/s^2.
    source_frequency, source_frequency_deviation : ndarray, shape (..., n_lines)
        Hz; NaN = line never heard.
    reborn : ndarray of bool, shape (..., n_lines)
        Lines that turned out to be another source now and were started anew.
    manoeuvre : ndarray of bool, shape (...)
        The target began to manoeuvre, says the detector, at this instant.
    restarted : ndarray of bool, shape (...)
        The estimator had lost the target and started anew.
    """

    stamp: int
    mean: FloatArray
    covariance: FloatArray
    source_frequency: FloatArray
    source_frequency_deviation: FloatArray
    reborn: BoolArray
    manoeuvre: BoolArray
    restarted: BoolArray
