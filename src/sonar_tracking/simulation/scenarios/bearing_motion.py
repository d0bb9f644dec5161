"""Targets given by their bearing history alone.

Arrival angles are from array broadside, positive towards increasing element x. Every motion has
one verb, ``arrival(times, receiver)``, which returns the angle and its exact rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.platforms import Receiver


class TargetMotion(Protocol):
    """How the sound of a target arrives at the array."""

    def arrival(self, times: FloatArray, receiver: Receiver) -> tuple[FloatArray, FloatArray]:
        """Return the arrival angle at the array and its rate.

        Parameters
        ----------
        times : ndarray, shape (...)
            Of reception, s.
        receiver : Receiver
            The array.

        Returns
        -------
        angle, rate : ndarray, shape (...)
            rad from broadside, rad/s.
        """


@dataclass(frozen=True)
class ArctangentMotion:
    """A pass at constant velocity: theta = offset + arctan(w (t - crossing_time)).

    A target on a straight course seen from a fixed array, w = speed / range at the closest point;
    the sources of Ryu, Park, Choi 2003 move like this.
    """

    kind: str = parameter("arctangent", "kind of motion", choices=("arctangent",))
    rate_deg: float = parameter(1.0, "bearing rate w at the crossing time; signed", unit="deg/s")
    crossing_time: float = parameter(0.0, "when the bearing is offset_deg", unit="s")
    offset_deg: float = parameter(
        0.0, "bearing at the crossing time", unit="deg", minimum=-90.0, maximum=90.0
    )

    def arrival(self, times: FloatArray, receiver: Receiver) -> tuple[FloatArray, FloatArray]:
        """Return angle and rate of arrival, rad and rad/s, at times, shape (...), s."""
        rate = np.radians(self.rate_deg)
        argument = rate * (times - self.crossing_time)
        angle = np.radians(self.offset_deg) + np.arctan(argument)
        return angle, rate / (1.0 + argument**2)


@dataclass(frozen=True)
class LinearMotion:
    """Constant bearing rate: theta = offset + rate (t - reference_time)."""

    kind: str = parameter("linear", "kind of motion", choices=("linear",))
    offset_deg: float = parameter(
        0.0, "bearing at the reference time", unit="deg", minimum=-90.0, maximum=90.0
    )
    rate_deg: float = parameter(0.0, "bearing rate", unit="deg/s")
    reference_time: float = parameter(0.0, "when the bearing is offset_deg", unit="s")

    def arrival(self, times: FloatArray, receiver: Receiver) -> tuple[FloatArray, FloatArray]:
        """Return angle and rate of arrival, rad and rad/s, at times, shape (...), s."""
        rate = np.radians(self.rate_deg)
        angle = np.radians(self.offset_deg) + rate * (times - self.reference_time)
        return angle, np.full_like(times, rate)


@dataclass(frozen=True)
class SinusoidalMotion:
    """Bearing to and fro: theta = offset + amplitude sin(2 pi t / period + phase)."""

    kind: str = parameter("sinusoidal", "kind of motion", choices=("sinusoidal",))
    offset_deg: float = parameter(0.0, "mean bearing", unit="deg", minimum=-90.0, maximum=90.0)
    amplitude_deg: float = parameter(
        30.0, "largest distance from the mean", unit="deg", minimum=0.0, maximum=90.0
    )
    period: float = parameter(100.0, "duration of one cycle", unit="s", minimum=1e-3)
    phase_deg: float = parameter(0.0, "phase of the cycle at scenario time 0", unit="deg")

    def arrival(self, times: FloatArray, receiver: Receiver) -> tuple[FloatArray, FloatArray]:
        """Return angle and rate of arrival, rad and rad/s, at times, shape (...), s."""
        frequency = 2.0 * np.pi / self.period
        phase = frequency * times + np.radians(self.phase_deg)
        amplitude = np.radians(self.amplitude_deg)
        angle = np.radians(self.offset_deg) + amplitude * np.sin(phase)
        return angle, amplitude * frequency * np.cos(phase)


@dataclass(frozen=True)
class TableMotion:
    """Bearings at given times with straight lines between; constant before and after."""

    kind: str = parameter("table", "kind of motion", choices=("table",))
    times: tuple[float, ...] = parameter((), "ascending times of the table", unit="s")
    bearings_deg: tuple[float, ...] = parameter(
        (), "bearing at each time", unit="deg", minimum=-90.0, maximum=90.0
    )

    def arrival(self, times: FloatArray, receiver: Receiver) -> tuple[FloatArray, FloatArray]:
        """Return angle and rate of arrival, rad and rad/s, at times, shape (...), s."""
        knots = np.array(self.times)
        bearings = np.radians(self.bearings_deg)
        slopes = np.concatenate([[0.0], np.diff(bearings) / np.diff(knots), [0.0]])
        rate = slopes[np.searchsorted(knots, times, side="right")]
        return np.interp(times, knots, bearings), rate
