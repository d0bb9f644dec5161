"""How well contacts fit particles: p(z_j | x_i), the polar Gaussian divided by the range.

A contact is as good as impossible for nearly all particles of all targets, so that those of a whole
cloud are computed only where a contact is near in azimuth and in range.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IndexArray

FARTHEST_DEVIATIONS = 12.0
"""Beyond them in range a density is zero: it would be below 1e-31 of its maximum."""

VANISHING_SQUARE = 1492.0
"""Squared distance from which exp(-x / 2) is exactly zero."""

FEW_CONTACTS = 8
"""Up to so many, as in the gate of one target, looking for near ones gains nothing."""


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
    """Range (m) and azimuth (rad) from the sensor, shape (n,)."""

    range: FloatArray
    azimuth: FloatArray


def particle_densities(
    state: FloatArray,
    contacts: PlacedContacts,
    sensor: SensorGeometry,
) -> FloatArray:
    """Return the densities of all particles and contacts.

    Parameters
    ----------
    state : ndarray, shape (n, 4)
        Particles x, y, vx, vy, m and m/s.
    contacts : PlacedContacts
        m contacts.
    sensor : SensorGeometry
        From where range and azimuth are measured. A particle is taken at its own reflection time.

    Returns
    -------
    ndarray, shape (n, m)
        1/m^2.
    """
    if len(contacts.distance) > FEW_CONTACTS:
        near = near_densities(state, contacts, sensor)
        density = np.zeros((len(state), len(contacts.distance)))
        density[near.particle, near.contact] = near.density
        return density
    particles, measured = _from_sensor(state, contacts, sensor)
    along = (measured.range - particles.range[:, None]) / sensor.range_standard_deviation
    turn = wrap_angle(measured.azimuth - particles.azimuth[:, None])
    density = _density(along, turn / sensor.azimuth_standard_deviation, measured.range, sensor)
    return np.where(np.abs(along) < FARTHEST_DEVIATIONS, density, 0.0)


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
    particles, measured = _from_sensor(state, contacts, sensor)
    reach = 1.001 * np.sqrt(VANISHING_SQUARE) * sensor.azimuth_standard_deviation
    particle, contact = _near_in_azimuth(particles.azimuth, measured.azimuth, reach)
    apart = measured.range.take(contact) - particles.range.take(particle)
    along = apart / sensor.range_standard_deviation
    near = np.flatnonzero(np.abs(along) < FARTHEST_DEVIATIONS)
    particle, contact, along = particle.take(near), contact.take(near), along.take(near)
    turn = wrap_angle(measured.azimuth.take(contact) - particles.azimuth.take(particle))
    across = turn / sensor.azimuth_standard_deviation
    density = _density(along, across, measured.range.take(contact), sensor)
    return NearDensities(particle, contact, density)


def _from_sensor(
    state: FloatArray, contacts: PlacedContacts, sensor: SensorGeometry
) -> tuple[_Polar, _Polar]:
    """Return range and azimuth of particles and contacts."""
    away = contacts.position - sensor.position
    contact_range = np.maximum(np.hypot(away[:, 0], away[:, 1]), 1.0)
    measured = _Polar(contact_range, np.arctan2(away[:, 1], away[:, 0]))
    x, y = state[:, 0] - sensor.position[0], state[:, 1] - sensor.position[1]
    if sensor.sound_speed > 0.0:
        delay = np.hypot(x, y) / sensor.sound_speed
        x, y = x + delay * state[:, 2], y + delay * state[:, 3]
    return _Polar(np.hypot(x, y), np.arctan2(y, x)), measured


def _density(
    along: FloatArray, across: FloatArray, contact_range: FloatArray, sensor: SensorGeometry
) -> FloatArray:
    errors = sensor.range_standard_deviation * sensor.azimuth_standard_deviation
    square = along**2 + across**2
    return np.asarray(np.exp(-0.5 * square) / (2.0 * np.pi * errors * contact_range))


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
