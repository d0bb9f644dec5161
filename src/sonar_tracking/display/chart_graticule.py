"""Latitudes and longitudes at the upper and right edge of a chart in metres."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.display.place_text import LATITUDE, LONGITUDE, angle_text
from sonar_tracking.geodesy import surface_places, surface_positions
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.datum import Datum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STEPS_DEG = tuple(
    step / 60_000.0
    for step in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 30_000)
)
"""Between two ticks, deg: from a thousandth of a minute to half a degree."""

_MOST_TICKS = 6


def draw_graticule(
    axes: Axes, low: FloatArray, high: FloatArray, scale: float, datum: Datum
) -> None:
    """Draw ticks of latitude on the meridian, and of longitude on the parallel, of the middle.

    Parameters
    ----------
    axes : Axes
        Of the chart.
    low, high : ndarray, shape (2,)
        Its corners, m.
    scale : float
        Units of the chart in a metre.
    datum : Datum
        Origin of ``map``.
    """
    middle = 0.5 * (low + high)
    centre = surface_places(middle, datum)
    corners = np.array([[low[0], middle[1]], [high[0], middle[1]], [middle[0], low[1]], middle])
    corners[3, 1] = high[1]
    west, east, south, north = surface_places(corners, datum)
    latitudes = _ticks(south[0], north[0])
    at_latitude = surface_positions(latitudes, np.full(len(latitudes), centre[1]), datum)
    longitudes = _ticks(west[1], east[1] + 360.0 * (east[1] < west[1]))
    at_longitude = surface_positions(np.full(len(longitudes), centre[0]), longitudes, datum)
    right, top = axes.secondary_yaxis("right"), axes.secondary_xaxis("top")
    turned = (longitudes + 180.0) % 360.0 - 180.0
    right.set_yticks(scale * at_latitude[:, 1], _texts(latitudes, *LATITUDE), fontsize=8)
    top.set_xticks(scale * at_longitude[:, 0], _texts(turned, *LONGITUDE), fontsize=8)


def _ticks(first: float, last: float) -> FloatArray:
    """Return round angles between two, deg."""
    wanted = (last - first) / _MOST_TICKS
    step = next((each for each in STEPS_DEG if each >= wanted), 1.0)
    return np.arange(np.ceil(first / step), np.floor(last / step) + 1) * step


def _texts(angles: FloatArray, digits: int, sides: str) -> list[str]:
    step = abs(float(angles[1] - angles[0])) if len(angles) > 1 else 1.0 / 60.0
    decimals = max(0, min(3, round(np.ceil(-np.log10(60.0 * step) - 1e-6))))
    return [angle_text(float(angle), digits, sides, decimals) for angle in angles]
