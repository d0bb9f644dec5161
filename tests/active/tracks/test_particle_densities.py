"""Protects: looking only at contacts near a particle leaves out nothing but exact zeros."""

import numpy as np
import pytest

from sonar_tracking.active.tracks import particle_densities as particle_densities_module
from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.active.tracks.particle_densities import near_densities, particle_densities
from tests.active.track_scene import contacts_at, densities_of

needs_it = pytest.mark.skipif(
    particle_densities_module.COMPILED is None, reason="no compiler was there: in numpy alone"
)


@pytest.mark.parametrize("way", ["compiled", "in numpy"])
@pytest.mark.parametrize("azimuth_deviation", [1e-4, 0.002, 0.03, 0.2, 3.0])
@pytest.mark.parametrize("sound_speed", [0.0, 1500.0])
def test_near_densities_are_all_that_are_not_zero(
    way: str, azimuth_deviation: float, sound_speed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All round the sensor, at any width of the sectors; against all particles and contacts."""
    if way == "in numpy":
        monkeypatch.setattr(particle_densities_module, "COMPILED", None)
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


@needs_it
@pytest.mark.parametrize("azimuth_deviation", [0.002, 0.03, 0.2, 3.0])
@pytest.mark.parametrize("n_contacts", [0, 1, 60, 900])
def test_compiled_and_in_numpy_find_the_same_pairs(
    azimuth_deviation: float, n_contacts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the same order, also where there are more than were made room for."""
    generator = np.random.default_rng(3)
    sensor = SensorGeometry(np.array([100.0, -50.0]), 40.0, azimuth_deviation, 1500.0)
    contacts = contacts_at(generator.uniform(-900.0, 900.0, (900, 2)).tolist())
    contacts = contacts.select(np.arange(n_contacts))
    state = np.hstack([generator.uniform(-900.0, 900.0, (200, 2)), np.ones((200, 2))])
    compiled = near_densities(state, contacts, sensor)
    monkeypatch.setattr(particle_densities_module, "COMPILED", None)
    plain = near_densities(state, contacts, sensor)
    assert compiled.particle.tolist() == plain.particle.tolist()
    assert compiled.contact.tolist() == plain.contact.tolist()
    assert compiled.density.tolist() == plain.density.tolist()


@needs_it
def test_columns_of_another_length_are_refused() -> None:
    assert particle_densities_module.COMPILED is not None
    one, two, rows = np.ones(1), np.ones(2), np.zeros(2, dtype=np.int64)
    for given in (
        (one, two, two, two, rows, rows, two),
        (two, two, one, two, rows, rows, two),
        (two, two, two, two, rows, rows[:1], two),
        (two, two, two, two, rows, rows, one),
    ):
        with pytest.raises(ValueError, match="shape"):
            particle_densities_module.COMPILED.near(given, 10, 1.0, 1.0, 12.0)


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
