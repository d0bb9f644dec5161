"""Bearings that a station measured, and what it is expected to measure of a target."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.alignment.aligned_targets import MOTION
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IndexArray

NEAREST = 1.0
"""A target is taken to be at least so far from a station, m."""


@dataclass(frozen=True)
class Bearings:
    """Azimuths that one station measured at one instant, one a target.

    Attributes
    ----------
    azimuth, variance : ndarray, shape (n,)
        In ``map``, as the data of the station tell, rad and rad^2.
    station : ndarray, shape (2,)
        Where it is, m.
    array : int
        Which misalignment it has.
    propagation_speed : float
        Of sound, m/s; inf = targets are heard where they are.
    other_side : ndarray, shape (n,), or None
        The azimuths on the other side of a line array, rad; NaN = there is none. Near its axis
        either may be meant.
    lag : float
        By how much the stamps of the station are late, s.
    """

    azimuth: FloatArray
    variance: FloatArray
    station: FloatArray
    array: int
    propagation_speed: float = np.inf
    other_side: FloatArray | None = None
    lag: float = 0.0

    def rows(self, rows: IndexArray | slice) -> Bearings:
        """Return some of them, in the order given; shape (n_chosen,)."""
        other = None if self.other_side is None else self.other_side[rows]
        azimuth, variance = self.azimuth[rows], self.variance[rows]
        return Bearings(
            azimuth, variance, self.station, self.array, self.propagation_speed, other, self.lag
        )

    @property
    def mirrored(self) -> Bearings | None:
        """The same on the other side; None = none has one. Impossible where there is none."""
        if self.other_side is None or np.all(np.isnan(self.other_side)):
            return None
        there = np.where(np.isnan(self.other_side), self.azimuth + np.pi, self.other_side)
        return replace(self, azimuth=there, other_side=None)

    def innovation(self, expected: FloatArray) -> FloatArray:
        """Return by how much azimuths differ from those expected, shape (n, ...), rad."""
        azimuth = self.azimuth.reshape(-1, *(1,) * (expected.ndim - 1))
        return np.asarray(wrap_angle(azimuth - expected))

    def expected(self, mean: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the azimuths of targets as their data will tell, and their derivatives.

        Parameters
        ----------
        mean : ndarray, shape (n, ..., d)
            m, m/s and rad.

        Returns
        -------
        azimuth : ndarray, shape (n, ...)
            rad.
        derivative : ndarray, shape (n, ..., d)
            By the state, rad/m, rad s/m and pure numbers.
        """
        east, north, speed_east, speed_north = (mean[..., axis] for axis in range(MOTION))
        east, north = east - self.station[0], north - self.station[1]
        delay = self.lag + np.hypot(east, north) / self.propagation_speed
        east, north = east - delay * speed_east, north - delay * speed_north
        square = np.maximum(east * east + north * north, NEAREST**2)
        derivative = np.zeros(mean.shape)
        for axis, across in enumerate((-north / square, east / square)):
            derivative[..., axis], derivative[..., 2 + axis] = across, -delay * across
        derivative[..., MOTION + self.array] = -1.0
        return np.arctan2(north, east) - mean[..., MOTION + self.array], derivative
