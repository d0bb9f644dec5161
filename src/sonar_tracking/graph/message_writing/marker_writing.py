"""Markers for RViz and Foxglove: what all pictures have in common.

Every array begins by deleting the one before it. What could not be seen, or would hide everything
else, is left out: what ends within its dot, has no width, is longer than any view, or is all but
transparent. What is tentative, coasted or one of two sides is fainter.

The colours are Okabe and Ito's, which colour-blind readers tell apart, on dark and on light.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from geometry_msgs.msg import Point
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from sonar_tracking.graph.message_writing.field_writing import (
    set_quaternion,
    set_vector,
    time_from_stamp,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import TrackHypothesis

Colour = tuple[float, float, float]

MARKER_SIZE = 100.0
"""Diameter of the dot at a position, by which all that has no size of its own is measured, m."""

LONGEST_ELLIPSE = 20_000.0
"""Length from which on an ellipse says no more than that the position is unknown, m."""

FAINTEST = 0.05
"""Opacity below which nothing is seen on any background."""

AREA_OPACITY = 0.3
"""Share of the opacity of its track: what lies below an ellipse or a wedge stays visible."""

TEXT_OPACITY = 0.7
"""Of the name of what is fainter: it can be read, or it is not there."""

COLOURS: dict[int, Colour] = {
    TrackHypothesis.SINGLE: (0.00, 0.62, 0.45),
    TrackHypothesis.LEFT: (0.84, 0.37, 0.00),
    TrackHypothesis.RIGHT: (0.34, 0.71, 0.91),
}
OPACITY: dict[int, float] = {
    TrackStatus.CONFIRMED: 1.0,
    TrackStatus.TENTATIVE: 0.4,
    TrackStatus.COASTED: 0.2,
}
"""Of what is drawn of a track, by its status; one that has ended is not drawn."""


def picture_header(stamp: int, frame_id: str) -> Header:
    """Return the header all markers of one picture share.

    Parameters
    ----------
    stamp : int
        ns.
    frame_id : str
        Frame of all coordinates.
    """
    return Header(stamp=time_from_stamp(stamp), frame_id=frame_id)


def new_marker(header: Header, kind: int, namespace: str, number: int) -> Marker:
    """Return a marker without size and colour, not turned.

    Parameters
    ----------
    header : Header
        See :func:`picture_header`.
    kind : int
        A type of Marker, e.g. ``Marker.SPHERE``.
    namespace : str
        What it shows; viewers let the reader turn each off.
    number : int
        Names it within its namespace.
    """
    return Marker(header=header, type=kind, ns=namespace, id=number, action=Marker.ADD)


def new_text(
    header: Header, namespace: str, number: int, text: str, place: tuple[float, float], size: float
) -> Marker:
    """Return a text that is beside what it names when seen from above.

    Parameters
    ----------
    header, namespace, number
        As in :func:`new_marker`.
    text : str
        What is written.
    place : tuple of float
        Middle of the text, m.
    size : float
        Diameter of a dot, m.
    """
    marker = new_marker(header, Marker.TEXT_VIEW_FACING, namespace, number)
    set_vector(marker.pose.position, (*place, size))
    marker.scale.z = 2.5 * size
    marker.text = text
    return marker


def set_colour(marker: Marker, colour: Colour, opacity: float) -> None:
    """Set the colour of a marker.

    Parameters
    ----------
    marker : Marker
        Changed.
    colour : tuple of float
        Red, green, blue, 0 to 1.
    opacity : float
        0 to 1.
    """
    marker.color.r, marker.color.g, marker.color.b = colour
    marker.color.a = min(opacity, 1.0)


def set_turn(marker: Marker, azimuth: float) -> None:
    """Turn a marker about the vertical, anticlockwise, rad."""
    half = 0.5 * azimuth
    set_quaternion(marker.pose.orientation, (0.0, 0.0, math.sin(half), math.cos(half)))


def points_from(positions: FloatArray) -> list[Point]:
    """Return positions in the plane, shape (n, 2), m, as the points of a marker."""
    return [Point(x=x, y=y, z=0.0) for x, y in positions.tolist()]


def picture(header: Header, markers: Iterable[Marker]) -> MarkerArray:
    """Return what replaces the picture before: the markers that can be seen.

    Parameters
    ----------
    header : Header
        See :func:`picture_header`.
    markers : iterable of Marker
        Coloured.
    """
    clear = Marker(header=header, action=Marker.DELETEALL)
    seen = [marker for marker in markers if marker.color.a >= FAINTEST]
    return MarkerArray(markers=[clear, *seen])
