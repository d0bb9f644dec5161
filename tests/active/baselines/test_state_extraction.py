"""Protects the states found in a cloud: clusters, weights, medians that outliers do not move."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.baselines import state_extraction
from sonar_tracking.active.baselines.state_extraction import extract_states
from sonar_tracking.active.tracks.particle_cloud import ParticleCloud
from sonar_tracking.records.arrays import FloatArray

CENTRES = np.array(
    [[0.0, 0.0, 1.0, 2.0], [500.0, 0.0, -1.0, 0.0], [0.0, 700.0, 3.0, -2.0], [9e3, 9e3, 0.0, 0.0]]
)


def cloud_at(centres: FloatArray, masses: list[float], each: int = 400) -> ParticleCloud:
    generator = np.random.default_rng(1)
    parts = [centre + generator.normal(0.0, [5.0, 10.0, 0.5, 1.0], (each, 4)) for centre in centres]
    weight = np.repeat(np.array(masses) / each, each)
    order = generator.permutation(len(weight))
    return ParticleCloud(np.vstack(parts)[order], np.zeros(len(weight), int), weight[order])


@pytest.mark.parametrize("seed", range(5))
def test_targets_apart_are_found_with_their_masses(seed: int) -> None:
    masses = [1.0, 0.8, 0.5, 1.2]
    peaks = extract_states(cloud_at(CENTRES, masses), 4, np.random.default_rng(seed))
    for centre, mass in zip(CENTRES, masses, strict=True):
        row = int(np.argmin(np.linalg.norm(peaks.state[:, :2] - centre[:2], axis=1)))
        assert peaks.state[row] == pytest.approx(centre, abs=2.0)
        assert peaks.mass[row] == pytest.approx(mass)
        deviation = np.sqrt(np.diag(peaks.covariance[row]))
        assert deviation == pytest.approx([5.0, 10.0, 0.5, 1.0], rel=0.15)


def test_a_state_is_the_weighted_median_of_each_component() -> None:
    state = np.array([[1.0, 8.0, 0.0, 0.0], [2.0, 6.0, 1.0, 0.0], [1e4, 7.0, 2.0, 0.0]])
    cloud = ParticleCloud(state, np.zeros(3, int), np.array([1.0, 3.0, 1.0]))
    peaks = extract_states(cloud, 1, np.random.default_rng(1))
    assert peaks.state.tolist() == [[2.0, 6.0, 1.0, 0.0]]
    assert peaks.mass.tolist() == [5.0]
    even = ParticleCloud(state, np.zeros(3, int), np.array([2.0, 2.0, 3.0]))
    assert extract_states(even, 1, np.random.default_rng(1)).state.tolist() == [
        [2.0, 7.0, 1.0, 0.0]
    ]


def test_no_targets_no_weight_and_fewer_clusters_than_asked_for() -> None:
    generator = np.random.default_rng(2)
    cloud = cloud_at(CENTRES[:1], [1.0])
    assert len(extract_states(cloud, 0, generator).mass) == 0
    light = ParticleCloud(cloud.state, cloud.mode, np.full(400, 1e-13))
    assert extract_states(light, 2, generator).state.shape == (0, 4)
    point = ParticleCloud(np.ones((5, 4)), np.zeros(5, int), np.full(5, 0.2))
    single = extract_states(point, 3, generator)
    assert single.mass == pytest.approx([1.0]), "of clusters without particles nothing is said"


def test_weightless_particles_draw_no_cluster() -> None:
    state = np.vstack([np.zeros((50, 4)), np.full((50, 4), 1e6)])
    weight = np.concatenate([np.full(50, 0.02), np.zeros(50)])
    peaks = extract_states(
        ParticleCloud(state, np.zeros(100, int), weight), 1, np.random.default_rng(3)
    )
    assert peaks.state.tolist() == [[0.0] * 4]


def test_clusters_that_stay_as_they_are_need_no_more_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many steps as wanted, or fewer: the same clusters, also those of overlapping targets."""
    centres = CENTRES * np.array([0.03, 0.03, 1.0, 1.0])
    cloud = cloud_at(centres, [1.0, 0.8, 0.5, 1.2])
    monkeypatch.setattr(state_extraction, "ITERATIONS", 10_000)
    settled = extract_states(cloud, 6, np.random.default_rng(3))
    monkeypatch.setattr(state_extraction, "ITERATIONS", 200)
    assert extract_states(cloud, 6, np.random.default_rng(3)).state == pytest.approx(settled.state)
    assert np.sum(settled.mass) == pytest.approx(3.5)
