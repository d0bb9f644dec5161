"""Protects the clouds beside the bank: whose they are, their densities, their weights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.particle_tracks import (
    GatedClouds,
    ParticleTracks,
    pair_densities,
    predict_particles,
    update_particles,
)
from sonar_tracking.active.tracks.contact_gating import GatePairs, SensorGeometry
from sonar_tracking.active.tracks.pair_updates import update_pairs
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.track_bank import TrackBank
from tests.active.track_scene import bank_of, contacts_at

COUNT = 4000
CONFIGURATION = ContactTrackerConfiguration(n_particles=COUNT, acceleration_deviation=0.0)
SENSOR = SensorGeometry(np.zeros(2), 10.0, 0.005, 0.0)
ONE = SceneRows((3,))
"""All of one scene."""


def bank() -> TrackBank:
    """Return two confirmed tracks and a candidate between them."""
    made = bank_of([[1000.0, 2000.0], [3000.0, 0.0], [-2000.0, 500.0]])
    return replace(made, confirmed=np.array([True, False, True]))


def moved(particles: ParticleTracks) -> TrackBank:
    """Return the bank after no time."""
    return predict_particles([particles], bank(), ONE, 0.0) if particles.used else bank()


def densities(particles: ParticleTracks, pairs: GatePairs, contacts: PlacedContacts) -> GatedClouds:
    (gated,) = pair_densities([particles], bank(), ONE, pairs, contacts, [SENSOR])
    return gated


def started(used: bool = True) -> ParticleTracks:
    particles = ParticleTracks(CONFIGURATION, used)
    particles.keep(bank())
    return particles


def test_clouds_follow_confirmed_tracks_alone() -> None:
    # Straight or turning by lateral_acceleration: the mean is that of the track all the same.
    after = moved(started())
    before = bank()
    assert after.mean[1].tolist() == before.mean[1].tolist()
    for row in (0, 2):
        off = (after.mean[row, 0] - before.mean[row, 0]) / np.sqrt(
            np.diag(before.covariance[row, 0])
        )
        assert np.all(np.abs(off) < 5.0 / np.sqrt(COUNT))
        assert np.any(off != 0.0)
        spread = np.diag(after.covariance[row, 0]) / np.diag(before.covariance[row, 0])
        assert spread == pytest.approx(np.ones(4), abs=5.0 * np.sqrt(2.0 / COUNT))


def test_a_cloud_lasts_as_long_as_its_track() -> None:
    particles = started()
    first = moved(particles)
    particles.keep(bank())  # nothing begins again
    assert moved(particles).mean[0] == pytest.approx(first.mean[0])
    particles.keep(bank().select(np.array([1, 2])))
    after = moved(particles)
    assert after.mean[0].tolist() == bank().mean[0].tolist(), "forgotten with its track"
    assert after.mean[2] == pytest.approx(first.mean[2])


def test_trackers_without_particles_have_no_clouds() -> None:
    unused = moved(started(used=False))
    assert unused.mean.tolist() == bank().mean.tolist()


def test_contacts_weigh_a_cloud_as_they_weigh_a_gaussian() -> None:
    """A large cloud of a Gaussian gives the Kalman update, and the same densities."""
    particles, before = started(), bank()
    contacts = contacts_at([[1010.0, 1990.0], [3000.0, 0.0], [-2010.0, 505.0], [-1980.0, 530.0]])
    # The sensor's polar errors, as covariances in the plane.
    direction = contacts.position / contacts.distance[:, None]
    across = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    noise = 100.0 * direction[:, :, None] * direction[:, None]
    lateral = (0.005 * contacts.distance) ** 2
    noise += lateral[:, None, None] * across[:, :, None] * across[:, None]
    contacts = replace(contacts, covariance=noise)
    pairs = GatePairs(np.array([0, 1, 2, 2]), np.array([0, 1, 2, 3]))
    gaussian = update_pairs(before, contacts, pairs)
    gated = densities(particles, pairs, contacts)
    assert gated.rows.tolist() == [0, 2, 3], "a candidate has no cloud"
    assert gated.pairs.mean == pytest.approx(gaussian.density[[0, 2, 3], 0], rel=0.1)
    after = update_particles([particles], before, ONE, [gated], np.array([1.0, 1.0, 0.6, 0.3]))
    assert after.mean[1].tolist() == before.mean[1].tolist()
    certain = before.mean[0, 0] + gaussian.correction[0, 0]
    assert after.mean[0, 0, :2] == pytest.approx(certain[:2], abs=1.5)
    mixed = before.mean[2, 0] + 0.6 * gaussian.correction[2, 0] + 0.3 * gaussian.correction[3, 0]
    assert after.mean[2, 0, :2] == pytest.approx(mixed[:2], abs=1.5)


def test_a_contact_far_from_all_particles_leaves_finite_weights() -> None:
    particles, before = started(), bank()
    contacts = contacts_at([[9000.0, 9000.0]])
    pairs = GatePairs(np.array([0]), np.array([0]))
    gated = densities(particles, pairs, contacts)
    assert gated.pairs.mean[0] == 1e-30
    after = update_particles([particles], before, ONE, [gated], np.array([0.2]))
    assert np.all(np.isfinite(after.mean))


def test_only_the_ratios_of_the_weights_count() -> None:
    """Those of a cloud need not sum to one: four times as heavy, it says the same."""
    contacts = contacts_at([[1010.0, 1990.0]])
    pairs = GatePairs(np.array([0]), np.array([0]))
    found, means = [], []
    for factor in (1.0, 4.0):
        particles = started()
        particles.clouds = replace(particles.clouds, weight=factor * particles.clouds.weight)
        gated = densities(particles, pairs, contacts)
        found.append(gated.pairs.mean[0])
        after = update_particles([particles], bank(), ONE, [gated], np.array([0.7]))
        means.append(after.mean)
    assert found[0] > 1e-6
    assert found[1] == pytest.approx(found[0], rel=1e-12)
    np.testing.assert_allclose(means[1], means[0], rtol=1e-12)
