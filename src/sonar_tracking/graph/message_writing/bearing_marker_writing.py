"""What is heard as markers for RViz and Foxglove: rays from the sensors, and their uncertainty.

A line array that cannot tell its sides apart gives two rays, left and right in the colours of these
hypotheses, each as faint as an even chance is. A ray says nothing of the distance: it is as long as
the reader wants. The wedge about it holds the target with 95 % probability, as an ellipse does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from sonar_tracking.graph.message_writing.field_writing import set_vector
from sonar_tracking.graph.message_writing.marker_writing import (
    AREA_OPACITY,
    COLOURS,
    MARKER_SIZE,
    OPACITY,
    TEXT_OPACITY,
    new_marker,
    new_text,
    picture,
    picture_header,
    points_from,
    set_colour,
)
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks
from sonar_tracking.records.positions import MAP_FRAME, TrackHypothesis
from sonar_tracking.tma.targets.station_view import StationView

RAY_LENGTH = 6_000.0
"""Of a ray, m."""

DEVIATIONS = 1.96
"""Standard deviations to either side that hold 95 %."""

WIDEST = math.radians(90.0)
"""Width from which on a wedge says no more than that the bearing is unknown, rad."""

STEP = math.radians(3.0)
"""Largest angle of one triangle of a wedge, rad."""

SIDE_NAMES = {
    TrackHypothesis.SINGLE: "",
    TrackHypothesis.LEFT: "_left",
    TrackHypothesis.RIGHT: "_right",
}


@dataclass(frozen=True)
class _Ray:
    """One ray of a bearing: azimuth, first edge and width of its wedge, rad; NaN = unknown."""

    azimuth: float
    first_edge: float
    width: float
    hypothesis: TrackHypothesis
    opacity: float


def bearing_markers(
    heard: Sequence[tuple[BearingTracks, StationView]],
    stamp: int,
    length: float = RAY_LENGTH,
    size: float = MARKER_SIZE,
) -> MarkerArray:
    """Return rays, wedges and names of all running bearing tracks, as far as they can be seen.

    Parameters
    ----------
    heard : sequence of (BearingTracks, StationView)
        What each station has heard last, and where it was.
    stamp : int
        Of the picture, ns.
    length : float
        Of a ray, m.
    size : float
        Diameter of the dot of a position, m; a ray is a fifth of it wide.

    Returns
    -------
    MarkerArray
        In the frame ``map``.
    """
    header = picture_header(stamp, MAP_FRAME)
    markers: list[Marker] = []
    for tracks, view in heard:
        for row in range(len(tracks.id)):
            for ray in _rays(tracks, view, row):
                markers += _of_ray(header, view, ray, row, length, size)
                markers.append(_name(header, view, ray, row, int(tracks.id[row]), length, size))
    return picture(header, markers)


def _rays(tracks: BearingTracks, view: StationView, row: int) -> Iterator[_Ray]:
    """Yield one ray, or one on either side; none of what has ended or has no angle."""
    angle = float(tracks.arrival_angle[row])
    opacity = OPACITY.get(int(tracks.status[row]), 0.0)
    if not opacity or not math.isfinite(angle):
        return
    variance = float(tracks.covariance[row, 0, 0])
    half = DEVIATIONS * math.sqrt(variance) if 0.0 < variance < math.inf else math.nan
    low, high = angle - half, angle + half
    if tracks.angle_kind is AngleKind.CONE:  # no angle from broadside is beyond the ends
        low, high = max(low, -0.5 * math.pi), min(high, 0.5 * math.pi)
    sides = [
        view.azimuths(each, tracks.angle_kind, bool(tracks.ambiguous[row]))
        for each in (angle, low, high)
    ]
    both = (TrackHypothesis.LEFT, TrackHypothesis.RIGHT)
    hypotheses = both if len(sides[0]) > 1 else (TrackHypothesis.SINGLE,)
    for hypothesis, azimuth, first, last in zip(hypotheses, *sides, strict=True):
        width = float(wrap_angle(last - first)) if high - low < WIDEST else math.nan
        yield _Ray(azimuth, first, width, hypothesis, opacity / len(hypotheses))


def _of_ray(
    header: Header, view: StationView, ray: _Ray, row: int, length: float, size: float
) -> list[Marker]:
    """Return a ray, and its wedge if that is wider than the ray."""
    place, side = np.array(view.position), SIDE_NAMES[ray.hypothesis]
    colour = COLOURS[ray.hypothesis]
    line = new_marker(header, Marker.LINE_STRIP, f"{view.sensor_id}/ray{side}", row)
    line.points = points_from(np.stack([place, place + length * _directions(ray.azimuth)]))
    line.scale.x = 0.2 * size
    set_colour(line, colour, ray.opacity)
    if not abs(ray.width) * length > line.scale.x:
        return [line]
    wedge = new_marker(header, Marker.TRIANGLE_LIST, f"{view.sensor_id}/wedge{side}", row)
    edges = ray.first_edge + np.linspace(0.0, ray.width, 1 + math.ceil(abs(ray.width) / STEP))
    outer = place + length * _directions(edges)
    inner = np.broadcast_to(place, outer[1:].shape)
    triangles = np.stack([inner, outer[:-1], outer[1:]], axis=1)
    wedge.points = points_from(triangles.reshape(-1, 2))
    set_vector(wedge.scale, (1.0, 1.0, 1.0))
    set_colour(wedge, colour, AREA_OPACITY * ray.opacity)
    return [line, wedge]


def _name(
    header: Header, view: StationView, ray: _Ray, row: int, name: int, length: float, size: float
) -> Marker:
    """Return the name of a bearing track, beyond the end of its ray."""
    x, y = np.array(view.position) + (length + 2.0 * size) * _directions(ray.azimuth)
    namespace = f"{view.sensor_id}/name{SIDE_NAMES[ray.hypothesis]}"
    text = new_text(header, namespace, row, str(name), (float(x), float(y)), size)
    set_colour(text, COLOURS[ray.hypothesis], max(ray.opacity, TEXT_OPACITY))
    return text


def _directions(azimuth: ArrayLike) -> FloatArray:
    """Return unit vectors, shape (..., 2)."""
    return np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
