"""Weighted k-means: points near each other, and compiled the bits of the coding in numpy."""

from __future__ import annotations

import shutil
import sysconfig
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.active.baselines import weighted_clusters as clustering
from sonar_tracking.active.baselines.weighted_clusters import weighted_clusters
from sonar_tracking.records.arrays import FloatArray

needs_it = pytest.mark.skipif(
    clustering.COMPILED is None, reason="no compiler was there: in numpy alone"
)


def points(seed: int, n_points: int) -> tuple[FloatArray, FloatArray]:
    """Return positions about four places, shape (2, n_points), and weights."""
    generator = np.random.default_rng(seed)
    places = generator.uniform(-5000.0, 5000.0, (2, 4))
    position = places[:, generator.integers(0, 4, n_points)]
    position = position + generator.normal(0.0, 40.0, (2, n_points))
    return position, generator.random(n_points)


@pytest.mark.parametrize("way", ["compiled", "in numpy"])
def test_points_belong_to_the_nearest_weighted_mean(
    way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if way == "in numpy":
        monkeypatch.setattr(clustering, "COMPILED", None)
    position, weight = points(1, 400)
    order, counts = weighted_clusters(position, weight, np.random.default_rng(1).random(4), 1000)
    assert sorted(order.tolist()) == list(range(400))
    rows = np.split(order, np.cumsum(counts)[:-1])
    assert all(np.all(np.diff(own) > 0) for own in rows)
    means = np.stack([np.average(position[:, own], axis=1, weights=weight[own]) for own in rows])
    for index, own in enumerate(rows):
        away = np.linalg.norm(position.T[own, None] - means, axis=2)
        assert np.all(np.argmin(away, axis=1) == index)


@needs_it
@pytest.mark.parametrize(
    ("n_points", "n_clusters"), [(1, 1), (5, 9), (800, 1), (800, 4), (300, 12)]
)
@pytest.mark.parametrize("iterations", [0, 1, 10])
def test_compiled_and_in_numpy_give_the_same_clusters(
    n_points: int, n_clusters: int, iterations: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    for seed in range(10):
        position, weight = points(seed, n_points)
        weight[: n_points // 3] = 0.0 if seed % 2 else 1e-200
        luck = np.random.default_rng(seed).random(n_clusters)
        with monkeypatch.context() as patch:
            compiled = weighted_clusters(position, weight, luck, iterations)
            patch.setattr(clustering, "COMPILED", None)
            plain = weighted_clusters(position, weight, luck, iterations)
        for one, other in zip(compiled, plain, strict=True):
            assert one.tolist() == other.tolist()


@pytest.mark.skipif(
    shutil.which("cc") is None or not Path(sysconfig.get_path("include"), "Python.h").is_file(),
    reason="no compiler is there, or no headers of Python",
)
def test_it_is_compiled_where_a_compiler_is() -> None:
    assert clustering.COMPILED is not None


@needs_it
def test_columns_of_another_length_are_refused() -> None:
    assert clustering.COMPILED is not None
    one, two, rows = np.ones(1), np.ones(2), np.zeros(2, dtype=np.int64)
    for given in ((two, one, two, one), (two, two, one, one), (one[:0], one[:0], one[:0], one)):
        with pytest.raises(ValueError, match="length"):
            clustering.COMPILED.cluster(*given, rows, rows[:1].copy(), 10)
