"""Rows of a bearing-time record: mean power of every beam over a span of time.

The beams of a line array are even in the sine of the arrival angle from -1 to 1, both endfires
among them: there all beams are equally wide, and none is an artefact of the edge. Those of any
other array are even in the arrival angle all round, the first following on the last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.geometry import beamwidth, is_line
from sonar_tracking.records.arrays import FloatArray

LEAST_POWER = 1e-30
"""Stands for no power at all where a logarithm is taken, linear."""

BEAMS_PER_WIDTH = 6
"""Between two of so many beams a peak of the beam pattern loses at most 0.1 dB."""

FEWEST_BEAMS, MOST_BEAMS = 91, 721

ROUND_BEAMS = 2.0 * math.pi
"""An arrival angle all round, rad."""


@dataclass(frozen=True)
class BeamAxis:
    """Where the beams of a row point.

    Attributes
    ----------
    first, step : float
        Sine of the arrival angle of the first beam and between neighbours, pure numbers; or the
        angle itself, rad.
    count : int
        Beams.
    sine : bool
        Whether it is the sine.
    """

    first: float
    step: float
    count: int
    sine: bool

    @property
    def angles(self) -> FloatArray:
        """Arrival angles from broadside, shape (count,), rad."""
        values: FloatArray = np.asarray(self.first + self.step * np.arange(self.count), np.float64)
        return np.arcsin(np.clip(values, -1.0, 1.0)) if self.sine else values


@dataclass(frozen=True)
class BeamRow:
    """One row.

    Attributes
    ----------
    begin, end : int
        Span of the data in it, ns.
    axis : BeamAxis
        Where the beams point.
    power : ndarray, shape (axis.count,)
        Mean power of each beam, linear: a plane wave has in its own direction the power it has on
        one element.
    integrated : float
        Duration of the data, s; less than the span where data are missing.
    sensor_id : str
        Of the array.
    axis_azimuth : float
        Of +x of the array in ``map``, rad; NaN = unknown.
    """

    begin: int
    end: int
    axis: BeamAxis
    power: FloatArray
    integrated: float
    sensor_id: str = "array"
    axis_azimuth: float = math.nan

    @property
    def middle(self) -> int:
        """Middle of the span, ns."""
        return (self.begin + self.end) // 2

    @property
    def level_db(self) -> NDArray[np.float32]:
        """Mean power in decibel, shape (axis.count,), dB."""
        return (10.0 * np.log10(np.maximum(self.power, LEAST_POWER))).astype(np.float32)


def beam_axis(positions: FloatArray, wavenumber: float) -> BeamAxis:
    """Return the beams of an array.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        Highest in the band, rad/m.
    """
    return _kept(np.ascontiguousarray(positions, np.float64).tobytes(), wavenumber)


@lru_cache(maxsize=16)
def _kept(position_bytes: bytes, wavenumber: float) -> BeamAxis:
    positions = np.frombuffer(position_bytes).reshape(-1, 3)
    width = beamwidth(positions, wavenumber) / BEAMS_PER_WIDTH
    if is_line(positions):
        count = 2 * round(1.0 / width) + 1
        count = min(max(count, FEWEST_BEAMS), MOST_BEAMS)
        return BeamAxis(-1.0, 2.0 / (count - 1), count, sine=True)
    count = min(max(2 * round(math.pi / width), 2 * FEWEST_BEAMS), 2 * MOST_BEAMS)
    return BeamAxis(-math.pi, ROUND_BEAMS / count, count, sine=False)
