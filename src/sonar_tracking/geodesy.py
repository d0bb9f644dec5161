"""Latitude, longitude and height on WGS 84, and the local frame east, north, up of a datum.

Both ways are in closed form. The frame is the tangent plane of the ellipsoid at the datum: 50 km
away the surface of the sea lies 196 m below it, so that a place on the surface is not one of z = 0.
:func:`surface_places` and :func:`surface_positions` convert what floats.

References
----------
National Imagery and Mapping Agency (2000). Department of Defense World Geodetic System 1984,
TR8350.2, third edition, table 3.1.

H. Vermeille (2002). Direct transformation from geocentric coordinates to geodetic coordinates.
Journal of Geodesy 76, 451-454.
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.datum import Datum

SEMI_MAJOR_AXIS = 6_378_137.0
"""Of the ellipsoid of WGS 84, m."""

FLATTENING = 1.0 / 298.257223563
"""Of the same, a pure number."""

ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)

FARTHEST = 200_000.0
"""From the datum, m: beyond it the tangent plane is no map."""

_MEAN_RADIUS = 6_371_000.0
"""Of the Earth, m."""

_SMALL_STEP = 1e-4
"""Along a meridian, deg: 11 m."""

_SURFACE_STEPS = 4
"""The error of the height shrinks by (distance / radius)^2 a step: 1e-4 at 60 km."""


def geodetic_to_local(places: FloatArray, datum: Datum) -> FloatArray:
    """Return east, north and up of places.

    Parameters
    ----------
    places : ndarray, shape (..., 3)
        Latitude and longitude, rad, and height above the ellipsoid, m.
    datum : Datum
        Origin of the frame.

    Returns
    -------
    ndarray, shape (..., 3)
        m.
    """
    origin = _geocentric(_origin(datum))
    return np.asarray((_geocentric(np.asarray(places, float)) - origin) @ _axes(datum).T)


def local_to_geodetic(positions: FloatArray, datum: Datum) -> FloatArray:
    """Return the places of positions east, north and up of a datum.

    Parameters
    ----------
    positions : ndarray, shape (..., 3)
        m.
    datum : Datum
        Origin of the frame.

    Returns
    -------
    ndarray, shape (..., 3)
        Latitude and longitude, rad in [-pi/2, pi/2] and [-pi, pi], and height above the
        ellipsoid, m.
    """
    return _geodetic(np.asarray(positions, float) @ _axes(datum) + _geocentric(_origin(datum)))


def surface_positions(
    latitude_deg: FloatArray, longitude_deg: FloatArray, datum: Datum
) -> FloatArray:
    """Return x and y in ``map`` of what floats at the height of the datum.

    Parameters
    ----------
    latitude_deg, longitude_deg : ndarray, shape (...)
        deg, as read from a file.
    datum : Datum
        Origin of ``map``.

    Returns
    -------
    ndarray, shape (..., 2)
        East and north, m.
    """
    latitude, longitude = np.radians(latitude_deg), np.radians(longitude_deg)
    height = np.full(latitude.shape, datum.height)
    places = np.stack([latitude, longitude, height], axis=-1)
    return geodetic_to_local(places, datum)[..., :2]


def surface_places(positions: FloatArray, datum: Datum) -> FloatArray:
    """Return latitude and longitude of what floats at the height of the datum.

    Parameters
    ----------
    positions : ndarray, shape (..., 2)
        x and y in ``map``, m; NaN = unknown.
    datum : Datum
        Origin of ``map``.

    Returns
    -------
    ndarray, shape (..., 2)
        deg; NaN where the position is not known.
    """
    positions = np.asarray(positions, float)
    local = np.concatenate([positions, np.zeros((*positions.shape[:-1], 1))], axis=-1)
    places = local_to_geodetic(local, datum)
    for _ in range(_SURFACE_STEPS):
        local[..., 2] += datum.height - places[..., 2]
        places = local_to_geodetic(local, datum)
    return np.degrees(places[..., :2])


def north_azimuths(latitude_deg: FloatArray, longitude_deg: FloatArray, datum: Datum) -> FloatArray:
    """Return in which direction of ``map`` true north lies at some places.

    Meridians meet at the pole: 50 km east of a datum at 54 degrees north it is turned by 0.6
    degrees.

    Parameters
    ----------
    latitude_deg, longitude_deg : ndarray, shape (...)
        deg.
    datum : Datum
        Origin of ``map``.

    Returns
    -------
    ndarray, shape (...)
        Azimuths, anticlockwise from east, rad.
    """
    latitude = np.asarray(latitude_deg, float)
    south = surface_positions(latitude - _SMALL_STEP, longitude_deg, datum)
    north = surface_positions(latitude + _SMALL_STEP, longitude_deg, datum)
    east, along = np.moveaxis(north - south, -1, 0)
    return np.asarray(np.arctan2(along, east))


def surface_distances(
    latitude_deg: FloatArray, longitude_deg: FloatArray, datum: Datum
) -> FloatArray:
    """Return how far places are from a datum along the surface, to half a percent (a sphere).

    Parameters
    ----------
    latitude_deg, longitude_deg : ndarray, shape (...)
        deg.
    datum : Datum
        From where.

    Returns
    -------
    ndarray, shape (...)
        m.
    """
    latitude, longitude = np.radians(latitude_deg), np.radians(longitude_deg)
    origin, meridian = np.radians(datum.latitude_deg), np.radians(datum.longitude_deg)
    half = np.sin(0.5 * (latitude - origin)) ** 2
    half += np.cos(latitude) * np.cos(origin) * np.sin(0.5 * (longitude - meridian)) ** 2
    return np.asarray(2.0 * _MEAN_RADIUS * np.arcsin(np.sqrt(np.clip(half, 0.0, 1.0))))


def _origin(datum: Datum) -> FloatArray:
    latitude, longitude = math.radians(datum.latitude_deg), math.radians(datum.longitude_deg)
    return np.array([latitude, longitude, datum.height])


def _axes(datum: Datum) -> FloatArray:
    """Return the unit vectors east, north and up in geocentric axes, shape (3, 3), a row each."""
    latitude, longitude, _ = _origin(datum)
    sine, cosine = math.sin(latitude), math.cos(latitude)
    east = [-math.sin(longitude), math.cos(longitude), 0.0]
    north = [-sine * math.cos(longitude), -sine * math.sin(longitude), cosine]
    up = [cosine * math.cos(longitude), cosine * math.sin(longitude), sine]
    return np.array([east, north, up])


def _geocentric(places: FloatArray) -> FloatArray:
    """Return geocentric x, y, z of places, shapes (..., 3), m."""
    latitude, longitude, height = places[..., 0], places[..., 1], places[..., 2]
    sine, cosine = np.sin(latitude), np.cos(latitude)
    normal = SEMI_MAJOR_AXIS / np.sqrt(1.0 - ECCENTRICITY_SQUARED * sine**2)
    across = (normal + height) * cosine
    along = (normal * (1.0 - ECCENTRICITY_SQUARED) + height) * sine
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), along], axis=-1)


def _geodetic(points: FloatArray) -> FloatArray:
    """Return latitude, longitude (rad) and height (m) of geocentric points, shapes (..., 3).

    The names of the quantities are those of Vermeille (2002), section 2.
    """
    e2, e4 = ECCENTRICITY_SQUARED, ECCENTRICITY_SQUARED**2
    across, along = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
    p = (across / SEMI_MAJOR_AXIS) ** 2
    q = (1.0 - e2) * (along / SEMI_MAJOR_AXIS) ** 2
    r = (p + q - e4) / 6.0
    s = e4 * p * q / (4.0 * r**3)
    t = np.cbrt(1.0 + s + np.sqrt(s * (2.0 + s)))
    u = r * (1.0 + t + 1.0 / t)
    v = np.sqrt(u**2 + e4 * q)
    w = e2 * (u + v - q) / (2.0 * v)
    k = np.sqrt(u + v + w**2) - w
    d = k * across / (k + e2)
    reach = np.hypot(d, along)
    latitude = 2.0 * np.arctan2(along, d + reach)
    longitude = np.arctan2(points[..., 1], points[..., 0])
    return np.stack([latitude, longitude, (k + e2 - 1.0) / k * reach], axis=-1)
