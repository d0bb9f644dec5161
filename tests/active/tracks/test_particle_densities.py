"""Protects: looking only at contacts near a particle leaves out nothing but exact zeros."""

import numpy as np
import pytest

from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.active.tracks.particle_densities import near_densities, particle_densities
from tests.active.track_scene import contacts_at, densities_of


@pytest.mark.parametrize("azimuth_deviation", [1e-4, 0.002, 0.03, 0.2, 3.0])
@pytest.mark.parametrize("sound_speed", [0.0, 1500.0])
def test_near_densities_are_all_that_are_not_zero(
    azimuth_deviation: float, sound_speed: float
) -> None:
    """All round the sensor, at any width of the sectors; against all particles and contacts."""
    generator = np.random.default_rng(1)
    sensor = SensorGeometry(np.array([100.0, -50.0]), 40.0, azimuth_deviation, sound_speed)
    contacts = contacts_at(generator.uniform(-2000.0, 2000.0, (60, 2)).tolist())
    near_contacts = contacts.position[generator.integers(0, 60, 600)]
    position = near_contacts + generator.normal(0.0, 30.0, (600, 2))
    state = np.hstack([position, generator.normal(0.0, 3.0, (600, 2))])
    expected = densities_of(state, contacts, sensor)
    assert np.count_nonzero(expected) > 20
    near = near_densities(state, contacts, sensor)
    found = np.zeros(expected.shape)
    found[near.particle, near.contact] = near.density
    np.testing.assert_array_equal(found, expected)
    assert near.particle.tolist() == sorted(near.particle.tolist())
    cells = set(zip(near.particle.tolist(), near.contact.tolist(), strict=True))
    assert len(cells) == len(near.density), "no pair twice"


def test_sectors_meet_at_180_degrees() -> None:
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.002, 0.0)
    contacts = contacts_at([[-1000.0, 1.0], [-1000.0, -1.0], [1000.0, 0.0]] * 4)
    state = np.array([[-1000.0, -1.0, 0.0, 0.0], [-1000.0, 1.0, 0.0, 0.0]])
    density = densities_of(state, contacts, sensor)
    assert np.all(density[:, :2] > 0.5 * density.max())
    assert np.all(density[:, 2] == 0.0)


def test_without_contacts_or_particles_there_are_no_densities() -> None:
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.002, 0.0)
    state, contacts = np.ones((3, 4)), contacts_at([[10.0, 10.0]] * 20)
    nothing = contacts.select(np.arange(0))
    assert densities_of(state, nothing, sensor).shape == (3, 0)
    assert len(near_densities(state, nothing, sensor).density) == 0
    assert densities_of(state[:0], contacts, sensor).shape == (0, 20)


def test_each_contact_is_compared_with_its_own_cloud() -> None:
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.002, 0.0)
    state = np.random.default_rng(2).normal([1000.0, 500.0, 0.0, 0.0], 10.0, (3, 40, 4))
    contacts = contacts_at([[1000.0, 500.0], [1010.0, 505.0], [990.0, 495.0]])
    cloud, contact = np.array([0, 0, 2, 2, 2]), np.array([0, 1, 0, 1, 2])
    density = particle_densities(state, cloud, contacts.select(contact), sensor)
    for row, (own, other) in enumerate(zip(cloud, contact, strict=True)):
        expected = densities_of(state[own], contacts.select(np.array([other])), sensor)[:, 0]
        np.testing.assert_array_equal(density[row], expected)
