"""How well contacts fit particles: p(z_j | x_i), the polar Gaussian divided by the range.

A contact is as good as impossible for nearly all particles of all targets, so that those of a whole
cloud are computed only where a contact is near in azimuth and in range.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

FARTHEST_DEVIATIONS = 12.0
"""Beyond them in range or azimuth a density is zero: it would be below 1e-31 of its maximum."""


@dataclass(frozen=True)
class NearDensities:
    """Densities that are not zero.

    Attributes
    ----------
    particle, contact : ndarray of int, shape (n_pairs,)
        Rows of both, those of the particles ascending.
    density : ndarray, shape (n_pairs,)
        1/m^2.
    """

    particle: IndexArray
    contact: IndexArray
    density: FloatArray


@dataclass(frozen=True)
class _Polar:
    """Range (m) and azimuth (rad) from the sensor, shape (..., n)."""

    range: FloatArray
    azimuth: FloatArray


def particle_densities(
    state: FloatArray,
    cloud: IndexArray,
    contacts: PlacedContacts,
    sensor: SensorGeometry,
) -> FloatArray:
    """Return the densities of all particles of a cloud, for each of some contacts.

    Parameters
    ----------
    state : ndarray, shape (n_clouds, n, 4)
        Particles x, y, vx, vy, m and m/s.
    cloud : ndarray of int, shape (n_contacts,)
        Whose particles each contact is compared with.
    contacts : PlacedContacts
        A contact as often as clouds are compared with it.
    sensor : SensorGeometry
        From where range and azimuth are measured. A particle is taken at its own reflection time.

    Returns
    -------
    ndarray, shape (n_contacts, n)
        1/m^2.
    """
    particles, measured = _of_particles(state, sensor), _of_contacts(contacts, sensor)
    range_deviation, azimuth_deviation = (
        sensor.range_standard_deviation,
        sensor.azimuth_standard_deviation,
    )
    along = (measured.range[:, None] - particles.range[cloud]) / range_deviation
    turn = measured.azimuth[:, None] - particles.azimuth[cloud]
    across = _wrapped(turn) / azimuth_deviation
    density = np.exp(-0.5 * (along**2 + across**2))
    density /= 2.0 * np.pi * range_deviation * azimuth_deviation * measured.range[:, None]
    density[~(_near(along) & _near(across))] = 0.0
    return density


def near_densities(
    state: FloatArray, contacts: PlacedContacts, sensor: SensorGeometry
) -> NearDensities:
    """Return the densities of the particles and contacts near each other.

    Parameters
    ----------
    state : ndarray, shape (n, 4)
        Particles x, y, vx, vy, m and m/s.
    contacts : PlacedContacts
        Contacts.
    sensor : SensorGeometry
        From where range and azimuth are measured. A particle is taken at its own reflection time.
    """
    particles, measured = _of_particles(state, sensor), _of_contacts(contacts, sensor)
    range_deviation, azimuth_deviation = (
        sensor.range_standard_deviation,
        sensor.azimuth_standard_deviation,
    )
    reach = 1.001 * FARTHEST_DEVIATIONS * azimuth_deviation
    particle, contact = _near_in_azimuth(particles.azimuth, measured.azimuth, reach)
    along = (measured.range.take(contact) - particles.range.take(particle)) / range_deviation
    near = np.flatnonzero(_near(along))
    particle, contact, along = particle.take(near), contact.take(near), along.take(near)
    turn = measured.azimuth.take(contact) - particles.azimuth.take(particle)
    across = _wrapped(turn) / azimuth_deviation
    near = np.flatnonzero(_near(across))
    particle, contact = particle.take(near), contact.take(near)
    density = np.exp(-0.5 * (along.take(near) ** 2 + across.take(near) ** 2))
    density /= 2.0 * np.pi * range_deviation * azimuth_deviation * measured.range.take(contact)
    return NearDensities(particle, contact, density)


def _of_contacts(contacts: PlacedContacts, sensor: SensorGeometry) -> _Polar:
    away = contacts.position - sensor.position
    distance = np.maximum(np.hypot(away[:, 0], away[:, 1]), 1.0)
    return _Polar(distance, np.arctan2(away[:, 1], away[:, 0]))


def _of_particles(state: FloatArray, sensor: SensorGeometry) -> _Polar:
    """Return where particles are when the sound reaches them."""
    x, y = (state[..., axis] - sensor.position[axis] for axis in (0, 1))
    if sensor.sound_speed > 0.0:
        delay = np.hypot(x, y) / sensor.sound_speed
        x, y = x + delay * state[..., 2], y + delay * state[..., 3]
    return _Polar(np.hypot(x, y), np.arctan2(y, x))


def _near(deviations: FloatArray) -> BoolArray:
    return np.abs(deviations) < FARTHEST_DEVIATIONS


def _wrapped(turn: FloatArray) -> FloatArray:
    """Return differences of angles brought into [-pi, pi], rad; no division with remainder."""
    return turn - 2.0 * np.pi * np.rint(turn / (2.0 * np.pi))


def _near_in_azimuth(
    azimuth: FloatArray, others: FloatArray, reach: float
) -> tuple[IndexArray, IndexArray]:
    """Return rows of azimuths and of others that may be within reach of each other, rad.

    Those of each sector, as wide as the reach, and of both neighbours.
    """
    n_sectors = int(min(2.0 * np.pi / reach, 4096.0))
    if n_sectors < 3 or not len(others):
        row = np.arange(len(azimuth)).repeat(len(others))
        return row, np.tile(np.arange(len(others)), len(azimuth))
    sector = _sectors(azimuth, n_sectors)
    sector_of_others = _sectors(others, n_sectors)
    order = np.argsort(sector_of_others, kind="stable")
    around = np.concatenate([order, order, order])
    each = np.bincount(sector_of_others, minlength=n_sectors)
    # Where each sector begins in three turns of the others.
    begins = np.concatenate([[0], np.cumsum(np.tile(each, 3))])
    first = begins[n_sectors - 1 : 2 * n_sectors - 1]
    counts = (begins[n_sectors + 2 : 2 * n_sectors + 2] - first).take(sector)
    row = np.arange(len(azimuth)).repeat(counts)
    shift = first.take(sector) - (np.cumsum(counts) - counts)
    return row, around.take(np.arange(len(row)) + shift.take(row))


def _sectors(azimuth: FloatArray, count: int) -> IndexArray:
    """Return the sector of each azimuth out of so many from -pi to pi."""
    share = (azimuth + np.pi) * (count / (2.0 * np.pi))
    return np.minimum(share.astype(np.intp), count - 1)
