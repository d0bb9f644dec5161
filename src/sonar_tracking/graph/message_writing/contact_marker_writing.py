"""Contacts and the gates of the tracks as markers for RViz and Foxglove.

Contacts are spheres, whose size is in metres in every viewer (that of points is in pixels where the
view has no perspective). Their colour tells the amplitude, from grey to yellow, which also those
see who are colour-blind. Gates are outlines, so that they are not taken for uncertainty ellipses,
with the threshold that is in force there.
"""

from __future__ import annotations

import math

import numpy as np
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.filtering.uncertainty_ellipse import uncertainty_ellipse
from sonar_tracking.graph.message_writing.field_writing import set_vector
from sonar_tracking.graph.message_writing.marker_writing import (
    LONGEST_ELLIPSE,
    MARKER_SIZE,
    Colour,
    new_marker,
    new_text,
    picture,
    picture_header,
    points_from,
    set_colour,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts, GateThresholds
from sonar_tracking.records.positions import MAP_FRAME

FAINT, STRONG = np.array([0.45, 0.47, 0.55]), np.array([1.00, 0.91, 0.22])
"""Colours of the contacts at the ends of the scale: the upper half of cividis, made lighter."""

FAINT_DB, STRONG_DB = 6.0, 18.0
"""Ends of the scale of amplitudes, dB over the mean of the noise; it does not follow the data, so
that the colours of two pings can be compared."""

GATE_COLOUR: Colour = (0.80, 0.47, 0.65)

GATE_PROBABILITY = -math.expm1(-0.5 * GATE_SIZE**2)
"""That the target is in its gate."""

GATE_POINTS = 49


def contact_markers(
    contacts: Contacts, positions: FloatArray, size: float = MARKER_SIZE
) -> MarkerArray:
    """Return the contacts of a ping as one list of spheres.

    Parameters
    ----------
    contacts : Contacts
        Of one ping.
    positions : ndarray, shape (n, 2)
        In ``map``, m; what is not finite is left out.
    size : float
        Diameter of the dot of a position, m; a contact is a little smaller.
    """
    header = picture_header(contacts.stamp, MAP_FRAME)
    seen = np.isfinite(positions).all(axis=1)
    if not seen.any():
        return picture(header, [])
    marker = new_marker(header, Marker.SPHERE_LIST, "contacts", 0)
    marker.points = points_from(positions[seen])
    set_vector(marker.scale, (0.8 * size, 0.8 * size, 0.8 * size))
    colours = amplitude_colours(contacts.amplitude, len(positions))[seen]
    marker.colors = [ColorRGBA(r=r, g=g, b=b, a=1.0) for r, g, b in colours.tolist()]
    set_colour(marker, (1.0, 1.0, 1.0), 1.0)
    return picture(header, [marker])


def amplitude_colours(amplitude: FloatArray, n_contacts: int) -> FloatArray:
    """Return the colours of contacts.

    Parameters
    ----------
    amplitude : ndarray, shape (n_contacts,) or (0,)
        Linear power, noise mean 1; NaN or empty = not measured, in the middle of the scale.
    n_contacts : int
        Number of contacts.

    Returns
    -------
    ndarray, shape (n_contacts, 3)
        Red, green and blue, pure numbers from 0 to 1.
    """
    measured = amplitude if len(amplitude) else np.full(n_contacts, np.nan)
    level = 10.0 * np.log10(np.maximum(measured, np.finfo(float).tiny))
    share = np.clip((level - FAINT_DB) / (STRONG_DB - FAINT_DB), 0.0, 1.0)
    share = np.where(np.isnan(share), 0.5, share)[:, None]
    return (1.0 - share) * FAINT + share * STRONG


def gate_markers(gates: GateThresholds, size: float = MARKER_SIZE) -> MarkerArray:
    """Return outlines of the gates with their thresholds, as far as they can be seen.

    Parameters
    ----------
    gates : GateThresholds
        Of the confirmed tracks, in ``map``.
    size : float
        Diameter of the dot of a position, m.
    """
    header = picture_header(gates.stamp, MAP_FRAME)
    markers: list[Marker] = []
    for row in range(len(gates.track_id)):
        markers += _gate(header, gates, row, size)
    for marker in markers:
        set_colour(marker, GATE_COLOUR, 1.0)
    return picture(header, markers)


def _gate(header: Header, gates: GateThresholds, row: int, size: float) -> list[Marker]:
    """Return the outline of a gate and its threshold; nothing if it is unknown, flat or too long.

    The threshold stands to the right: the name of the track is above its dot, or below.
    """
    centre = gates.predicted_position[row]
    found = uncertainty_ellipse(gates.gate_covariance[row], GATE_PROBABILITY)
    if found is None or not np.isfinite(centre).all():
        return []
    if found.semi_minor <= 0.0 or 2.0 * found.semi_major > LONGEST_ELLIPSE:
        return []
    outline = new_marker(header, Marker.LINE_STRIP, "gate", row)
    points = found.outline(centre, GATE_POINTS)
    outline.points = points_from(points)
    outline.scale.x = 0.15 * size
    threshold = float(gates.threshold[row])
    if not 0.0 < threshold < math.inf:
        return [outline]
    text = f"{10.0 * math.log10(threshold):.1f} dB"
    place = (float(points[:, 0].max()) + 3.0 * size, float(centre[1]))
    return [outline, new_text(header, "threshold", row, text, place, 0.8 * size)]
