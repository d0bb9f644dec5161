"""Position tracks as markers for RViz and Foxglove: position, velocity, uncertainty."""

from __future__ import annotations

import math

import numpy as np
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from sonar_tracking.filtering.uncertainty_ellipse import uncertainty_ellipse
from sonar_tracking.graph.message_writing.field_writing import set_vector
from sonar_tracking.graph.message_writing.marker_writing import (
    AREA_OPACITY,
    COLOURS,
    FAINTEST,
    LONGEST_ELLIPSE,
    MARKER_SIZE,
    OPACITY,
    TEXT_OPACITY,
    new_marker,
    new_text,
    picture,
    picture_header,
    points_from,
    set_colour,
    set_turn,
)
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource

ARROW_SECONDS = 60.0
"""An arrow ends where the target will be after this time."""


def position_markers(tracks: PositionTracks, size: float = MARKER_SIZE) -> MarkerArray:
    """Return dots, arrows, ellipses and names of all running tracks, as far as they can be seen.

    What is fixed is a cube.

    Parameters
    ----------
    tracks : PositionTracks
        The complete picture at its stamp.
    size : float
        Diameter of a dot, m.

    Returns
    -------
    MarkerArray
        In the frame of the tracks.
    """
    header = picture_header(tracks.stamp, tracks.frame_id)
    markers = []
    for row in range(len(tracks)):
        probability = float(tracks.hypothesis_probability[row])
        opacity = OPACITY.get(int(tracks.status[row]), 0.0)
        opacity *= probability if math.isfinite(probability) else 1.0
        if opacity < FAINTEST or not np.all(np.isfinite(tracks.state[row])):
            continue
        colour = COLOURS.get(int(tracks.hypothesis[row]), COLOURS[TrackHypothesis.SINGLE])
        special = {"ellipse": AREA_OPACITY * opacity, "name": max(opacity, TEXT_OPACITY)}
        for marker in _of_track(header, tracks, row, size):
            set_colour(marker, colour, special.get(marker.ns, opacity))
            markers.append(marker)
    return picture(header, markers)


def _of_track(header: Header, tracks: PositionTracks, row: int, size: float) -> list[Marker]:
    x, y, _, northward = (float(value) for value in tracks.state[row])
    static = int(tracks.source[row]) == TrackSource.STATIC
    position = new_marker(header, Marker.CUBE if static else Marker.SPHERE, "position", row)
    set_vector(position.pose.position, (x, y, 0.0))
    set_vector(position.scale, (size, size, size))
    beside = -2.0 * size if northward > 0.0 else 2.0 * size  # where the arrow does not go
    name = new_text(header, "name", row, str(int(tracks.id[row])), (x, y + beside), size)
    velocity = _velocity(header, tracks, row, size)
    return [position, *velocity, name, *_ellipse(header, tracks, row)]


def _velocity(header: Header, tracks: PositionTracks, row: int, size: float) -> list[Marker]:
    """Return the arrow of a track, or nothing if it would end within the dot."""
    state = tracks.state[row]
    ahead = ARROW_SECONDS * state[2:]
    if math.hypot(*ahead) <= 0.5 * size:
        return []
    velocity = new_marker(header, Marker.ARROW, "velocity", row)
    velocity.points = points_from(np.stack([state[:2], state[:2] + ahead]))
    set_vector(velocity.scale, (0.3 * size, 0.6 * size, 0.0))
    return [velocity]


def _ellipse(header: Header, tracks: PositionTracks, row: int) -> list[Marker]:
    """Return the ellipse of a track, or nothing if it is unknown, flat or too long."""
    found = uncertainty_ellipse(tracks.covariance[row])
    if found is None or found.semi_minor <= 0.0 or 2.0 * found.semi_major > LONGEST_ELLIPSE:
        return []
    ellipse = new_marker(header, Marker.CYLINDER, "ellipse", row)
    set_vector(ellipse.pose.position, (*tracks.state[row, :2], 0.0))
    set_turn(ellipse, found.azimuth)
    set_vector(ellipse.scale, (2.0 * found.semi_major, 2.0 * found.semi_minor, 1.0))
    return [ellipse]
