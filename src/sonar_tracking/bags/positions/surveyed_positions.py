"""Positions by time, whatever file they come from."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.records.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class SurveyedPositions:
    """Positions by time, of own ship or of one target.

    Attributes
    ----------
    stamp : ndarray of int, shape (n,)
        Ascending, ns.
    position : ndarray, shape (n, 2)
        East, north, m.
    azimuth : ndarray, shape (n,)
        Of the bow, rad; NaN = not given.
    source : str
        Where they come from, for sentences.
    velocity : ndarray, shape (n, 2), or None
        East, north, m/s, NaN = not given; None = none is.
    """

    stamp: IntArray
    position: FloatArray
    azimuth: FloatArray
    source: str = "own ship's track"
    velocity: FloatArray | None = None
