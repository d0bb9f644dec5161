"""Where and when contacts were reflected.

A ping leaves the sensor at p at the stamp and is received where the sensor is then, at
q = p + v L / c with L = 2 range. The contact lies on the ellipse with foci p and q, at the distance

    rho = (L^2 - d^2) / (2 (L + u . d)),    d = q - p,    u = direction of arrival,

from q, and was reflected (L - rho) / c after the stamp. Without propagation delay p = q and rho =
range.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.contacts import Contacts

IDENTITY = np.eye(2)

NEAR = 3.0
"""Deviations of the range, up to which a contact may as well be at the sensor."""


@dataclass(frozen=True)
class PlacedContacts:
    """Contacts in the plane.

    Attributes
    ----------
    position : ndarray, shape (n, 2)
        In ``map``, m.
    covariance : ndarray, shape (n, 2, 2)
        Of the position, m^2.
    distance : ndarray, shape (n,)
        From the receiver, m.
    delay : ndarray, shape (n,)
        From the stamp to the reflection, s.
    """

    position: FloatArray
    covariance: FloatArray
    distance: FloatArray
    delay: FloatArray

    def select(self, rows: IndexArray | slice) -> PlacedContacts:
        """Return some of the contacts, by their rows, shape (n_kept,)."""
        columns = (self.position, self.covariance, self.distance, self.delay)
        if isinstance(rows, slice):
            return PlacedContacts(*[column[rows] for column in columns])
        return PlacedContacts(*[column.take(rows, axis=0) for column in columns])


def place_contacts(contacts: Contacts, sound_speed: float) -> PlacedContacts:
    """Return where and when the contacts of a ping were reflected.

    Parameters
    ----------
    contacts : Contacts
        Of one ping.
    sound_speed : float
        m/s; 0 = the ping takes no time.
    """
    x, y = np.cos(contacts.azimuth), np.sin(contacts.azimuth)
    path = 2.0 * contacts.range
    from_x: FloatArray | float
    from_y: FloatArray | float
    (from_x, from_y), (speed_x, speed_y) = contacts.sensor_position, contacts.sensor_velocity
    if sound_speed > 0.0:
        travel = path / sound_speed
        shift_x, shift_y = travel * speed_x, travel * speed_y
        along = x * shift_x + y * shift_y
        distance = (path**2 - (shift_x**2 + shift_y**2)) / (2.0 * (path + along))
        delay = (path - distance) / sound_speed
        from_x, from_y = from_x + shift_x, from_y + shift_y
    else:
        distance, delay = path**2 / (2.0 * path), np.zeros(len(path))
    direction, position = np.empty((len(path), 2)), np.empty((len(path), 2))
    direction[:, 0], direction[:, 1] = x, y
    position[:, 0] = from_x + distance * x
    position[:, 1] = from_y + distance * y
    covariance = position_covariance(
        direction,
        distance,
        contacts.range_standard_deviation,
        contacts.azimuth_standard_deviation,
    )
    return PlacedContacts(position, covariance, distance, delay)


def position_covariance(
    direction: FloatArray,
    distance: FloatArray,
    range_standard_deviation: float | FloatArray,
    azimuth_standard_deviation: float | FloatArray,
) -> FloatArray:
    """Return rot diag(sigma_r^2, (r sigma_theta)^2) rot^T.

    Nearer than a few deviations of the range the direction says little of the place: what is at
    the sensor is seen anywhere around it. The error is then that of the range all around.

    Parameters
    ----------
    direction : ndarray, shape (n, 2)
        Unit vectors from the sensor.
    distance : ndarray, shape (n,)
        m.
    range_standard_deviation, azimuth_standard_deviation : float or ndarray, shape (n,)
        m and rad.

    Returns
    -------
    ndarray, shape (n, 2, 2)
        m^2.
    """
    along = np.square(range_standard_deviation)
    across = (distance * azimuth_standard_deviation) ** 2
    near = distance < NEAR * np.asarray(range_standard_deviation)
    if near.any():
        across = np.where(near, np.maximum(across, along), across)
    more, (x, y) = along - across, direction.T
    covariance = np.empty((len(distance), 2, 2))
    covariance[:, 0, 0] = across + more * (x * x)
    covariance[:, 1, 1] = across + more * (y * y)
    covariance[:, 0, 1] = covariance[:, 1, 0] = more * (x * y)
    return covariance
