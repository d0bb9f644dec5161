"""Places on the Earth as charts show them: degrees and minutes, and the side."""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.geodesy import surface_places
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.datum import Datum

UNKNOWN = "-"

LATITUDE, LONGITUDE = (2, "NS"), (3, "EW")
"""Digits of the degrees, and the sides."""


def place_text(position: FloatArray, datum: Datum) -> str:
    """Return latitude and longitude of a position, to 0.001 of a minute (2 m).

    Parameters
    ----------
    position : ndarray, shape (2,)
        x and y in ``map``, m; NaN = unknown.
    datum : Datum
        Origin of ``map``.
    """
    if not np.isfinite(position).all():
        return UNKNOWN
    latitude, longitude = surface_places(position, datum).tolist()
    return f"{angle_text(latitude, *LATITUDE)} {angle_text(longitude, *LONGITUDE)}"


def angle_text(angle_deg: float, digits: int, sides: str, decimals: int = 3) -> str:
    """Return a latitude or longitude.

    Parameters
    ----------
    angle_deg : float
        deg, north and east positive.
    digits : int
        Of the degrees.
    sides : str
        The letters of positive and of negative angles.
    decimals : int
        Of the minutes.
    """
    unit = 60 * 10**decimals
    whole, rest = divmod(round(abs(angle_deg) * unit), unit)
    width = 3 + decimals if decimals else 2
    side = sides[math.copysign(1.0, angle_deg) < 0.0]
    return f"{whole:0{digits}d}°{rest / 10**decimals:0{width}.{decimals}f}'{side}"
