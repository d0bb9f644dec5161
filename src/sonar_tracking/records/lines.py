"""What flows out of the line tracker: narrowband lines heard at one instant.

Stamps are integer nanoseconds, angles arrival angles: radians from array broadside, positive
towards increasing element x.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.records.arrays import FloatArray, IdArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.time import UNKNOWN_STAMP

NOT_ATTRIBUTED = 0
"""``track_id`` of a line that belongs to no bearing track."""

_OF_ALL_LINES = ("stamp", "next_stamp", "sensor")


@dataclass(frozen=True)
class FrequencyLines:
    """All lines heard at one instant; entry n of each column belongs to line n.

    Attributes
    ----------
    stamp : int
        Middle of the integration interval, ns.
    track_id : ndarray of uint64, shape (n_lines,)
        Bearing track the line belongs to; 0 = not attributed.
    arrival_angle : ndarray, shape (n_lines,)
        rad; NaN = unknown.
    arrival_angle_variance : ndarray, shape (n_lines,)
        rad^2; NaN = unknown.
    line_id : ndarray of uint64, shape (n_lines,)
        Identity of the line, never reused within a run.
    frequency : ndarray, shape (n_lines,)
        Received, Hz.
    standard_deviation : ndarray, shape (n_lines,)
        Of the frequency, Hz.
    signal_to_noise_ratio : ndarray, shape (n_lines,)
        Linear, in the analysis bandwidth; NaN = not estimated.
    integration_time : ndarray, shape (n_lines,)
        s; NaN = unknown.
    next_stamp : int
        Watermark, ns.
    sensor : Sensor
        The sensor that made the data.
    """

    stamp: int
    track_id: IdArray
    arrival_angle: FloatArray
    arrival_angle_variance: FloatArray
    line_id: IdArray
    frequency: FloatArray
    standard_deviation: FloatArray
    signal_to_noise_ratio: FloatArray
    integration_time: FloatArray
    next_stamp: int = UNKNOWN_STAMP
    sensor: Sensor = field(default_factory=Sensor)

    def without(self, rows: Sequence[bool]) -> FrequencyLines:
        """Return the lines but for some of them; one entry a line, True = is left out."""
        if not any(rows):
            return self
        kept = ~np.array(rows, dtype=bool)
        columns = [one.name for one in fields(self) if one.name not in _OF_ALL_LINES]
        return replace(self, **{name: getattr(self, name)[kept] for name in columns})


@dataclass(frozen=True)
class Beams:
    """Where the array listens at one instant.

    Attributes
    ----------
    track_id : ndarray of uint64, shape (n_beams,)
        Bearing tracks.
    arrival_angle, variance : ndarray, shape (n_beams,)
        rad and rad^2.
    """

    track_id: IdArray
    arrival_angle: FloatArray
    variance: FloatArray


@dataclass(frozen=True)
class LofarRows:
    """Spectra of the beams over their background, one row of the LOFAR picture of each.

    Attributes
    ----------
    stamp : int
        Middle of the frame, ns.
    track_id : ndarray of uint64, shape (n_beams,)
        Bearing track of each row.
    first_frequency, bin_width : float
        Of the columns, Hz.
    level_db : ndarray of float32, shape (n_beams, n_bins)
        Power over background, dB.
    frame_id : str
        Frame of the array.
    """

    stamp: int
    track_id: IdArray
    first_frequency: float
    bin_width: float
    level_db: NDArray[np.float32]
    frame_id: str


def no_lines(stamp: int, next_stamp: int, sensor: Sensor) -> FrequencyLines:
    """Return the empty list of an instant, ns."""
    nothing, nobody = np.empty(0), np.empty(0, np.uint64)
    return FrequencyLines(
        stamp=stamp,
        track_id=nobody,
        arrival_angle=nothing,
        arrival_angle_variance=nothing,
        line_id=nobody,
        frequency=nothing,
        standard_deviation=nothing,
        signal_to_noise_ratio=nothing,
        integration_time=nothing,
        next_stamp=next_stamp,
        sensor=sensor,
    )
