"""Bearings of successive covariances joined to a line: what may become a bearing track."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import seconds

_FIRST_ODDS = 0.25
_ODDS_OF_BEARING = 5.0
_ODDS_OF_MISS = 0.5
"""Odds of existence of a tentative track at its first bearing, and their factors for each bearing
joined and each miss: four bearings in a row make a probability of 0.97."""


@dataclass(frozen=True)
class TentativeTrack:
    """Bearings joined so far, of what may become a track.

    Attributes
    ----------
    id : int
        Identifier, kept when the track starts.
    stamps : tuple of int
        Middle of the covariance of each bearing, ns.
    angles, variances : tuple of float
        rad, rad^2.
    misses : int
        Covariances without a bearing since the last one.
    """

    id: int
    stamps: tuple[int, ...]
    angles: tuple[float, ...]
    variances: tuple[float, ...]
    misses: int = 0

    @property
    def existence_probability(self) -> float:
        """Probability that a source made these bearings."""
        joined = _ODDS_OF_BEARING ** (len(self.stamps) - 1)
        odds = _FIRST_ODDS * joined * _ODDS_OF_MISS**self.misses
        return odds / (1.0 + odds)

    def add(self, stamp: int, angle: float, variance: float) -> TentativeTrack:
        """Return the track with one more bearing, rad, and its variance, rad^2."""
        return replace(
            self,
            stamps=(*self.stamps, stamp),
            angles=(*self.angles, angle),
            variances=(*self.variances, variance),
            misses=0,
        )

    def line(self, stamp: int) -> tuple[FloatArray, FloatArray]:
        """Return angle and rate at an instant by the least-squares line through the bearings.

        Parameters
        ----------
        stamp : int
            ns.

        Returns
        -------
        mean : ndarray, shape (2,)
            rad, rad/s.
        covariance : ndarray, shape (2, 2)
            rad^2, rad^2/s, rad^2/s^2.
        """
        times = seconds(np.array(self.stamps, dtype=np.int64) - stamp)
        design = np.stack([np.ones_like(times), times], axis=-1)
        weights = 1.0 / np.array(self.variances)
        covariance = np.asarray(np.linalg.inv(design.T @ (weights[:, None] * design)), np.float64)
        return covariance @ (design.T @ (weights * np.array(self.angles))), covariance


@dataclass(frozen=True)
class StartedTrack:
    """A track at its first instant.

    Attributes
    ----------
    id : int
        Identifier.
    mean : ndarray, shape (2,)
        Angle and rate, rad and rad/s.
    covariance : ndarray, shape (2, 2)
        rad^2, rad^2/s, rad^2/s^2.
    excess : float
        Power of a faint source in its beam, over that of the noise, pure number; NaN = not faint.
    """

    id: int
    mean: FloatArray
    covariance: FloatArray
    excess: float = np.nan
