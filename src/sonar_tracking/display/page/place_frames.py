"""The frame by which the page tells places on the Earth: polynomials, so that any cursor has one.

Browsers know nothing of the ellipsoid: they are sent latitude and longitude as polynomials of x and
y, fitted to :func:`sonar_tracking.geodesy.surface_places`.
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.display.page.page_frames import Frame, text_frame
from sonar_tracking.geodesy import surface_places
from sonar_tracking.records.datum import Datum

REACH = 120_000.0
"""Of the polynomials from the datum along each axis, m."""

_DEGREE = 5
_POINTS = 25
"""Of the fit, along each axis."""


def datum_frame(datum: Datum) -> Frame:
    """Return the frame of the datum.

    ``latitude`` and ``longitude`` are coefficients, degrees, of the products of
    ``(x / reach)^powers[i][0]`` and ``(y / reach)^powers[i][1]``.
    """
    powers = [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]
    axis = np.linspace(-1.0, 1.0, _POINTS)
    x, y = (each.ravel() for each in np.meshgrid(axis, axis))
    places = surface_places(REACH * np.stack([x, y], axis=-1), datum)
    latitude, longitude = places.T
    longitude = datum.longitude_deg + (longitude - datum.longitude_deg + 180.0) % 360.0 - 180.0
    products = np.stack([x**i * y**j for i, j in powers], axis=-1)
    terms, *_ = np.linalg.lstsq(products, np.stack([latitude, longitude], axis=-1), rcond=None)
    return text_frame(
        "datum",
        math.nan,
        reach=REACH,
        powers=[list(each) for each in powers],
        latitude=terms[:, 0],
        longitude=terms[:, 1],
    )
