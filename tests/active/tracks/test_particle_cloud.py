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
    predict_cloud,
    resample_cloud,
    stacked,
    systematic_rows,
)
from tests.active.track_scene import COVARIANCE, contacts_at, densities_of


def test_resampling_keeps_mean_and_covariance() -> None:
    generator = np.random.default_rng(2)
    cloud = gaussian_cloud(np.array([10.0, 20.0, 1.0, 2.0]), COVARIANCE, 20_000, generator)
    weight = np.exp(-0.5 * ((cloud.state[:, 0] - 30.0) / 4.0) ** 2)
    cloud = ParticleCloud(cloud.state, cloud.mode, weight)
    mean, covariance = cloud.moments()
    resampled = resample_cloud(stacked(cloud), generator).select(0)
    assert resampled.weight == pytest.approx(np.full(20_000, 1.0 / 20_000))
    again, spread = resampled.moments()
    assert again == pytest.approx(mean, abs=1.0)
    assert np.diag(spread) == pytest.approx(np.diag(covariance), rel=0.1)


def test_particles_move_as_the_modes_do() -> None:
    generator = np.random.default_rng(3)
    state = np.tile([0.0, 0.0, 2.0, 1.0], (3, 1))
    cloud = ParticleCloud(state, np.arange(3), np.ones(3))
    moved = predict_cloud(cloud, ParticleMotion(0.0, 0.01, 1.0), 10.0, generator)
    rates = MotionModes(3, 0.0, 0.01, initial_speed_deviation=8.0).turn_rates(state[None, :, 2:])[0]
    expected = turn_matrices(rates, 10.0) @ state[0]
    assert moved.state == pytest.approx(expected)


def test_particle_density_is_one_over_the_plane() -> None:
    sensor = SensorGeometry(np.array([100.0, -50.0]), 30.0, 0.02, 0.0)
    axis = np.arange(-400.0, 400.0, 10.0)
    grid = np.stack(np.meshgrid(1100.0 + axis, 450.0 + axis), axis=-1).reshape(-1, 2)
    density = densities_of(
        np.array([[1100.0, 450.0, 0.0, 0.0]]), contacts_at(grid.tolist()), sensor
    )
    assert np.sum(density) * 100.0 == pytest.approx(1.0, abs=0.01)


def test_moments_are_those_of_the_weights() -> None:
    state = np.array([[0.0, 0.0, 1.0, 0.0], [10.0, 4.0, 1.0, 2.0]])
    mean, covariance = ParticleCloud(state, np.zeros(2, int), np.array([6.0, 2.0])).moments()
    assert mean == pytest.approx([2.5, 1.0, 1.0, 0.5])
    away = np.array([10.0, 4.0, 0.0, 2.0])
    assert covariance == pytest.approx(0.75 * 0.25 * np.outer(away, away))


def test_a_gaussian_cloud_has_its_mean_covariance_and_all_modes() -> None:
    root = np.random.default_rng(4).normal(size=(4, 4))
    covariance = root @ root.T
    count = 40_000
    cloud = gaussian_cloud(np.arange(4.0), covariance, count, np.random.default_rng(5))
    deviation = np.sqrt(np.diag(covariance))
    assert np.sum(cloud.weight) == pytest.approx(1.0)
    mean, spread = cloud.moments()
    # Five standard deviations of the estimates.
    assert np.all(np.abs(mean - np.arange(4.0)) < 5.0 * deviation / np.sqrt(count))
    scale = np.outer(deviation, deviation)
    assert np.all(np.abs(spread - covariance) < 5.0 * np.sqrt(2.0 / count) * scale)
    shares = np.bincount(cloud.mode, minlength=3) / count
    assert shares == pytest.approx(np.full(3, 1.0 / 3.0), abs=5.0 * np.sqrt(2.0 / 9.0 / count))
    certain = gaussian_cloud(np.arange(4.0), np.zeros((4, 4)), 10, np.random.default_rng(6))
    assert certain.state == pytest.approx(np.tile(np.arange(4.0), (10, 1)), abs=1e-3)


def test_particles_change_their_mode_and_are_pushed_by_one_acceleration() -> None:
    count, interval = 40_000, 6.0
    state = np.zeros((count, 4))
    cloud = ParticleCloud(state, np.ones(count, int), np.full(count, 1.0 / count))
    moved = predict_cloud(cloud, ParticleMotion(0.5, 0.0, 0.7), interval, np.random.default_rng(7))
    shares = np.bincount(moved.mode, minlength=3) / count
    assert shares == pytest.approx([0.15, 0.7, 0.15], abs=0.012)  # who changes, changes to both
    gain = np.vstack([0.5 * interval**2 * np.eye(2), interval * np.eye(2)])
    expected = 0.25 * gain @ gain.T
    _, covariance = moved.moments()
    assert covariance == pytest.approx(expected, abs=0.03 * expected[0, 0])
    assert moved.state[:, 0] == pytest.approx(0.5 * interval * moved.state[:, 2])
    assert moved.weight.tolist() == cloud.weight.tolist()


def test_a_slow_particle_turns_no_faster_than_at_three_tenths_of_a_metre_a_second() -> None:
    state = np.array([[0.0, 0.0, 0.1, 0.0], [0.0, 0.0, 0.6, 0.0]])
    cloud = ParticleCloud(state, np.array([1, 2]), np.ones(2))
    moved = predict_cloud(cloud, ParticleMotion(0.0, 0.03, 1.0), 5.0, np.random.default_rng(8))
    turned = np.arctan2(moved.state[:, 3], moved.state[:, 2])
    assert turned == pytest.approx([0.03 / 0.3 * 5.0, -0.03 / 0.6 * 5.0])


def test_a_density_is_the_polar_gaussian_at_the_reflection() -> None:
    sensor = SensorGeometry(np.array([100.0, -50.0]), 30.0, 0.02, 1500.0)
    state = np.array([[1100.0, 450.0, 20.0, -10.0], [-900.0, -50.0, 0.0, 0.0]])
    contacts = contacts_at([[1120.0, 430.0], [-900.0, -60.0], [-900.0, -40.0], [9000.0, 0.0]])
    density = densities_of(state, contacts, sensor)
    for row in range(2):
        position = state[row, :2] - sensor.position
        position = position + np.hypot(*position) / 1500.0 * state[row, 2:]
        for column in range(3):
            away = contacts.position[column] - sensor.position
            reach = np.hypot(*away)
            along = (reach - np.hypot(*position)) / 30.0
            turn = np.angle(complex(*away) / complex(*position)) / 0.02
            expected = np.exp(-0.5 * (along**2 + turn**2)) / (2.0 * np.pi * 0.6 * reach)
            assert density[row, column] == pytest.approx(expected, rel=1e-9, abs=1e-30)
    assert density[:, 3].tolist() == [0.0, 0.0], "too far away to count"
    # Both sides of the cut at 180 degrees are equally near.
    assert density[1, 1] == pytest.approx(density[1, 2])
    assert density[1, 1] > 1e-6


def test_systematic_draws_are_as_many_as_the_weights_say() -> None:
    """Never more than one off, and in order."""
    generator = np.random.default_rng(9)
    weight = np.array([0.0, 3.0, 0.5, 0.0, 6.5])
    for _ in range(50):
        rows = systematic_rows(weight, 20, generator)
        counts = np.bincount(rows, minlength=5)
        assert len(rows) == 20
        assert np.all(np.abs(counts - 2.0 * weight) < 1.0)
        assert rows.tolist() == sorted(rows.tolist())


def test_a_cloud_is_resampled_when_fewer_than_half_of_its_particles_count() -> None:
    generator = np.random.default_rng(10)
    state = generator.normal(size=(100, 4))
    for heavy, resampled in [(51, False), (49, True)]:
        weight = np.where(np.arange(100) < heavy, 2.0, 1e-12)
        cloud = ParticleCloud(state, np.zeros(100, int), weight)
        after = resample_cloud(stacked(cloud), generator).select(0)
        assert np.sum(after.weight) == pytest.approx(1.0)
        assert np.array_equal(after.state, state) == (not resampled)
        assert (np.ptp(after.weight) == 0.0) == resampled


def test_a_kernel_keeps_apart_what_was_drawn_twice() -> None:
    """Of the width that suits a Gaussian, 0.3 (4 / 6)^(1/8) n^(-1/8) of its deviations."""
    count = 5000
    generator = np.random.default_rng(11)
    state = np.repeat(np.array([[-1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]), count // 2, axis=0)
    weight = np.where(np.arange(count) % 4 == 0, 1.0, 0.0)
    cloud = ParticleCloud(state, np.zeros(count, int), weight)
    after = resample_cloud(stacked(cloud), generator).select(0)
    width = 0.3 * (2.0 / 3.0) ** 0.125 * count**-0.125
    left = after.state[after.state[:, 0] < 0.0, 0]
    assert np.std(left) == pytest.approx(width, rel=0.06)
    assert np.mean(left) == pytest.approx(-np.sqrt(1.0 - width**2), abs=0.02)
    assert np.var(after.state[:, 0]) == pytest.approx(1.0, rel=0.02)


def test_a_covariance_that_rounding_has_made_indefinite_is_mended() -> None:
    """Errors of 1 m in x and y alike: to rounding, y is off by as much as x, of variance 1."""
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = [[1.0, 1.0], [1.0, 1.0 - 1e-5]]
    cloud = gaussian_cloud(np.arange(4.0), covariance, 1000, np.random.default_rng(12))
    off = cloud.state - np.arange(4.0)
    assert off[:, 1] == pytest.approx(off[:, 0], abs=1e-2)
    assert np.var(off[:, 0]) == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / 1000))
    assert np.abs(off[:, 2:]).max() < 1e-2


def test_clouds_together_are_as_by_themselves_with_the_same_numbers() -> None:
    """Those whose weights are alike are left alone; the others are drawn in their order."""
    count, motion = 200, ParticleMotion(0.1, 0.02, 0.8)
    made = np.random.default_rng(13)
    singles = [gaussian_cloud(np.arange(4.0) * row, COVARIANCE, count, made) for row in range(4)]
    heavy = [np.ones(count), made.random(count) ** 8, np.ones(count), made.random(count) ** 9]
    clouds = [
        ParticleCloud(one.state, one.mode, own) for one, own in zip(singles, heavy, strict=True)
    ]
    together = ParticleCloud(
        *(np.stack([getattr(one, name) for one in clouds]) for name in ("state", "mode", "weight"))
    )
    alone, all_of_them = np.random.default_rng(14), np.random.default_rng(14)
    moved = predict_cloud(together, motion, 10.0, all_of_them)
    one_by_one = [predict_cloud(cloud, motion, 10.0, alone) for cloud in clouds]
    drawn = resample_cloud(moved, all_of_them)
    for row, cloud in enumerate(one_by_one):
        np.testing.assert_array_equal(moved.state[row], cloud.state)
        np.testing.assert_array_equal(moved.mode[row], cloud.mode)
        again = resample_cloud(stacked(cloud), alone).select(0)
        np.testing.assert_allclose(drawn.state[row], again.state, rtol=1e-12)
        np.testing.assert_array_equal(drawn.mode[row], again.mode)
        assert np.array_equal(again.state, cloud.state) == (row in (0, 2))
