"""Position tracks as markers for RViz and Foxglove: position, velocity, uncertainty.

Markers are pictures: they are neither recorded nor compared. Every array begins by deleting the
one before it. What is tentative, coasted or an improbable side is fainter. What could not be seen,
or would hide everything else, is left out: arrows within their dot, ellipses without width or of
which only a part would be in view, and whatever is all but transparent.
"""

from __future__ import annotations

import math

import numpy as np
from geometry_msgs.msg import Point
from visualization_msgs.msg import Marker, MarkerArray

from sonar_tracking.filtering.uncertainty_ellipse import uncertainty_ellipse
from sonar_tracking.graph.message_writing.field_writing import (
    set_quaternion,
    set_vector,
    time_from_stamp,
)
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis

ARROW_SECONDS = 60.0
"""An arrow ends where the target will be after this time."""

SIZE = 60.0
"""Diameter of the dot at a position, m."""

LONGEST_ELLIPSE = 20_000.0
"""Length from which on an ellipse says no more than that the position is unknown, m."""

FAINTEST = 0.05
"""Opacity below which nothing is seen on any background."""

ELLIPSE_OPACITY = 0.3
"""Share of the opacity of its track: what lies below an ellipse stays visible."""

COLOURS = {
    TrackHypothesis.SINGLE: (0.1, 0.8, 0.2),
    TrackHypothesis.LEFT: (0.9, 0.3, 0.2),
    TrackHypothesis.RIGHT: (0.2, 0.6, 0.9),
}
OPACITY = {TrackStatus.CONFIRMED: 1.0, TrackStatus.TENTATIVE: 0.4, TrackStatus.COASTED: 0.2}


def position_markers(tracks: PositionTracks) -> MarkerArray:
    """Return dots, arrows, ellipses and names of all running tracks, as far as they can be seen.

    Parameters
    ----------
    tracks : PositionTracks
        The complete picture at its stamp.

    Returns
    -------
    MarkerArray
        In the frame of the tracks.
    """
    markers = [_marker(tracks, Marker.SPHERE, "", 0, Marker.DELETEALL)]
    for row in range(len(tracks)):
        status = TrackStatus(int(tracks.status[row]))
        if status is TrackStatus.TERMINATED or not np.all(np.isfinite(tracks.state[row])):
            continue
        probability = float(tracks.hypothesis_probability[row])
        opacity = OPACITY[status] * (probability if math.isfinite(probability) else 1.0)
        colour = COLOURS[TrackHypothesis(int(tracks.hypothesis[row]))]
        for marker in _of_track(tracks, row):
            marker.color.r, marker.color.g, marker.color.b = colour
            marker.color.a = opacity * (ELLIPSE_OPACITY if marker.ns == "ellipse" else 1.0)
            if marker.color.a >= FAINTEST:
                markers.append(marker)
    return MarkerArray(markers=markers)


def _of_track(tracks: PositionTracks, row: int) -> list[Marker]:
    x, y = (float(value) for value in tracks.state[row, :2])
    position = _marker(tracks, Marker.SPHERE, "position", row)
    set_vector(position.pose.position, (x, y, 0.0))
    set_vector(position.scale, (SIZE, SIZE, SIZE))
    name = _marker(tracks, Marker.TEXT_VIEW_FACING, "name", row)
    set_vector(name.pose.position, (x, y, 2.0 * SIZE))
    name.scale.z = 2.0 * SIZE
    name.text = str(int(tracks.id[row]))
    return [position, *_velocity(tracks, row), name, *_ellipse(tracks, row)]


def _velocity(tracks: PositionTracks, row: int) -> list[Marker]:
    """Return the arrow of a track, or nothing if it would end within the dot."""
    x, y, vx, vy = (float(value) for value in tracks.state[row])
    if ARROW_SECONDS * math.hypot(vx, vy) <= 0.5 * SIZE:
        return []
    velocity = _marker(tracks, Marker.ARROW, "velocity", row)
    ahead = (x + ARROW_SECONDS * vx, y + ARROW_SECONDS * vy)
    velocity.points = [Point(x=x, y=y, z=0.0), Point(x=ahead[0], y=ahead[1], z=0.0)]
    set_vector(velocity.scale, (0.3 * SIZE, 0.6 * SIZE, 0.0))
    return [velocity]


def _ellipse(tracks: PositionTracks, row: int) -> list[Marker]:
    """Return the ellipse of a track, or nothing if it is unknown, flat or too long."""
    found = uncertainty_ellipse(tracks.covariance[row])
    if found is None or found.semi_minor <= 0.0 or 2.0 * found.semi_major > LONGEST_ELLIPSE:
        return []
    x, y = (float(value) for value in tracks.state[row, :2])
    ellipse = _marker(tracks, Marker.CYLINDER, "ellipse", row)
    set_vector(ellipse.pose.position, (x, y, 0.0))
    turn = (0.0, 0.0, math.sin(0.5 * found.azimuth), math.cos(0.5 * found.azimuth))
    set_quaternion(ellipse.pose.orientation, turn)
    set_vector(ellipse.scale, (2.0 * found.semi_major, 2.0 * found.semi_minor, 1.0))
    return [ellipse]


def _marker(
    tracks: PositionTracks, kind: int, namespace: str, number: int, action: int = Marker.ADD
) -> Marker:
    marker = Marker(type=kind, ns=namespace, id=number, action=action)
    marker.header.frame_id = tracks.frame_id
    marker.header.stamp = time_from_stamp(tracks.stamp)
    return marker
