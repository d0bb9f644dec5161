"""Element time series as they flow into the line tracker and the demodulator."""

from __future__ import annotations

from dataclasses import dataclass, field

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.time import NANOSECONDS, UNKNOWN_STAMP

MINIMUM_SAMPLE_RATE = 1000.0
"""Of broadband element time series, Hz."""


@dataclass(frozen=True)
class ArraySamples:
    """A contiguous block of broadband real element time series.

    Attributes
    ----------
    stamp : int
        Instant of the first sample, ns.
    data : ndarray, shape (n_samples, n_elements)
        Linear amplitude, values as single precision carries them.
    element_positions : ndarray, shape (n_elements, 3)
        In the sensor frame, m; order = data columns.
    sample_rate : float
        Hz.
    sound_speed : float
        m/s.
    next_stamp : int
        Watermark, ns.
    sensor : Sensor
        The sensor that made the data.
    """

    stamp: int
    data: FloatArray
    element_positions: FloatArray
    sample_rate: float
    sound_speed: float
    next_stamp: int = UNKNOWN_STAMP
    sensor: Sensor = field(default_factory=Sensor)

    @property
    def end_stamp(self) -> int:
        """Instant of the sample after the last one, ns."""
        return self.stamp + round(len(self.data) / self.sample_rate * NANOSECONDS)
