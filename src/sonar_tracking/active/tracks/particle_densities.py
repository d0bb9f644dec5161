"""How well contacts fit particles: p(z_j | x_i), the polar Gaussian divided by the range.

A contact is as good as impossible for nearly all particles of all targets, so that those of a whole
cloud are computed only where a contact is near in azimuth and in range. ``compiled_densities``,
which finds these, is there if a compiler was when the package was installed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

FARTHEST_DEVIATIONS = 12.0
"""Beyond them in range or azimuth a density is zero: it would be below 1e-31 of its maximum."""

COMPILED = compiled_module("active.tracks.compiled_densities")
"""The compiled function, None where there is none."""


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
    find = _near_pairs if COMPILED is None else _near_pairs_compiled
    particle, contact, square = find(particles, measured, sensor)
    density = np.exp(-0.5 * square)
    density /= 2.0 * np.pi * range_deviation * azimuth_deviation * measured.range.take(contact)
    return NearDensities(particle, contact, density)


def _near_pairs(
    particles: _Polar, measured: _Polar, sensor: SensorGeometry
) -> tuple[IndexArray, IndexArray, FloatArray]:
    """Return rows of near particles and contacts, and their distances in deviations, squared."""
    deviation = sensor.azimuth_standard_deviation
    particle, contact = _near_in_azimuth(particles.azimuth, measured.azimuth, _sectors(deviation))
    along = measured.range.take(contact) - particles.range.take(particle)
    along /= sensor.range_standard_deviation
    near = np.flatnonzero(_near(along))
    particle, contact, along = particle.take(near), contact.take(near), along.take(near)
    turn = measured.azimuth.take(contact) - particles.azimuth.take(particle)
    across = _wrapped(turn) / deviation
    near = np.flatnonzero(_near(across))
    square = along.take(near) ** 2 + across.take(near) ** 2
    return particle.take(near), contact.take(near), square


def _near_pairs_compiled(
    particles: _Polar, measured: _Polar, sensor: SensorGeometry
) -> tuple[IndexArray, IndexArray, FloatArray]:
    """Return the same."""
    columns = (particles.range, particles.azimuth, measured.range, measured.azimuth)
    given = tuple(map(np.ascontiguousarray, columns))
    deviations = (sensor.range_standard_deviation, sensor.azimuth_standard_deviation)
    count, room = 2 * len(particles.range), -1
    while count > room:
        room = count
        found = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room)
        limits = (_sectors(deviations[1]), *deviations, FARTHEST_DEVIATIONS)
        count = COMPILED.near((*given, *found), *limits)  # type: ignore[union-attr]
    particle, contact, square = found
    return particle[:count], contact[:count], square[:count]


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


def _sectors(azimuth_deviation: float) -> int:
    """Return how many sectors there are, as wide as the reach of a contact."""
    reach = 1.001 * FARTHEST_DEVIATIONS * azimuth_deviation
    return int(min(2.0 * np.pi / reach, 4096.0))


def _near_in_azimuth(
    azimuth: FloatArray, others: FloatArray, n_sectors: int
) -> tuple[IndexArray, IndexArray]:
    """Return rows of azimuths and of others that may be near each other, rad.

    Those of each sector and of both neighbours.
    """
    if n_sectors < 3 or not len(others):
        row = np.arange(len(azimuth)).repeat(len(others))
        return row, np.tile(np.arange(len(others)), len(azimuth))
    sector = _sector_of(azimuth, n_sectors)
    sector_of_others = _sector_of(others, n_sectors)
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


def _sector_of(azimuth: FloatArray, count: int) -> IndexArray:
    """Return the sector of each azimuth out of so many from -pi to pi."""
    share = (azimuth + np.pi) * (count / (2.0 * np.pi))
    return np.minimum(share.astype(np.intp), count - 1)
