"""Protects: resampling keeps the moments, particles move as the modes do, densities sum to one."""

import numpy as np
import pytest

from sonar_tracking.active.tracks.contact_gating import (
    SensorGeometry,
)
from sonar_tracking.active.tracks.motion_modes import MotionModes, turn_matrices
from sonar_tracking.active.tracks.particle_cloud import (
    ParticleCloud,
    ParticleMotion,
    gaussian_cloud,
    particle_densities,
    predict_cloud,
    resample_cloud,
)
from tests.active.track_scene import COVARIANCE, contacts_at


def test_resampling_keeps_mean_and_covariance() -> None:
    generator = np.random.default_rng(2)
    cloud = gaussian_cloud(np.array([10.0, 20.0, 1.0, 2.0]), COVARIANCE, 20_000, generator)
    weight = np.exp(-0.5 * ((cloud.state[:, 0] - 30.0) / 4.0) ** 2)
    cloud = ParticleCloud(cloud.state, cloud.mode, weight)
    mean, covariance = cloud.moments()
    resampled = resample_cloud(cloud, generator)
    assert resampled.weight == pytest.approx(np.full(20_000, 1.0 / 20_000))
    again, spread = resampled.moments()
    assert again == pytest.approx(mean, abs=1.0)
    assert np.diag(spread) == pytest.approx(np.diag(covariance), rel=0.1)


def test_particles_move_as_the_modes_do() -> None:
    generator = np.random.default_rng(3)
    state = np.tile([0.0, 0.0, 2.0, 1.0], (3, 1))
    cloud = ParticleCloud(state, np.arange(3), np.ones(3))
    moved = predict_cloud(cloud, ParticleMotion(0.0, 0.01, 1.0), 10.0, generator)
    rates = MotionModes(3, 0.0, 0.01).turn_rates(state[None, :, 2:])[0]
    expected = turn_matrices(rates, 10.0) @ state[0]
    assert moved.state == pytest.approx(expected)


def test_particle_density_is_one_over_the_plane() -> None:
    sensor = SensorGeometry(np.array([100.0, -50.0]), 30.0, 0.02, 0.0)
    axis = np.arange(-400.0, 400.0, 10.0)
    grid = np.stack(np.meshgrid(1100.0 + axis, 450.0 + axis), axis=-1).reshape(-1, 2)
    density = particle_densities(
        np.array([[1100.0, 450.0, 0.0, 0.0]]), contacts_at(grid.tolist()), sensor
    )
    assert np.sum(density) * 100.0 == pytest.approx(1.0, abs=0.01)
