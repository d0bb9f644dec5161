"""Weighted medians: half of the weight on either side, and compiled the bits of those sorted."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.baselines import weighted_medians as medians
from sonar_tracking.active.baselines.weighted_medians import weighted_medians

needs_it = pytest.mark.skipif(
    medians.COMPILED is None, reason="no compiler was there: in numpy alone"
)


@pytest.mark.parametrize("way", ["compiled", "in numpy"])
def test_half_of_the_weight_of_each_cluster_lies_up_to_its_median(
    way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if way == "in numpy":
        monkeypatch.setattr(medians, "COMPILED", None)
    generator = np.random.default_rng(1)
    counts = np.array([1, 2, 40, 700])
    state, weight = generator.normal(size=(743, 4)), generator.random(743)
    found = weighted_medians(state, weight, counts)
    ends = np.cumsum(counts)
    for row, (end, count) in enumerate(zip(ends, counts, strict=True)):
        own, weights = state[end - count : end], weight[end - count : end, None]
        half = 0.5 * np.sum(weights)
        assert np.all(np.sum(weights * (own <= found[row]), axis=0) >= half)
        assert np.all(np.sum(weights * (own < found[row]), axis=0) < half)


@needs_it
@pytest.mark.parametrize("kind", ["random", "alike", "without weight", "whole", "few values"])
def test_compiled_and_in_numpy_give_the_same_bits(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of equal weights, half of which lie up to a value, rounding decides: that of both."""
    for seed in range(20):
        generator = np.random.default_rng(seed)
        counts = generator.integers(1, 300, 8)
        n_particles = int(np.sum(counts))
        state, weight = generator.normal(size=(n_particles, 4)), generator.random(n_particles)
        if kind == "alike":
            weight[:] = 0.1 / 3.0
        elif kind == "without weight":
            weight[generator.random(n_particles) < 0.7] = 0.0
            weight[: counts[0]] = 0.0
        elif kind == "whole":
            weight = np.ceil(3.0 * weight)
        elif kind == "few values":
            state, weight = np.round(state), np.ceil(3.0 * weight)
        with monkeypatch.context() as patch:
            compiled = weighted_medians(state, weight, counts)
            patch.setattr(medians, "COMPILED", None)
            plain = weighted_medians(state, weight, counts)
        assert compiled.tolist() == plain.tolist()


@needs_it
def test_columns_of_another_shape_are_refused() -> None:
    assert medians.COMPILED is not None
    state, weight, counts, found = np.ones((3, 4)), np.ones(3), np.array([1, 2]), np.ones((2, 4))
    medians.COMPILED.medians(state, weight, counts, found)
    for given in (
        (state[:2], weight, counts, found),
        (state, weight, counts, found[:1]),
        (state, weight, np.array([0, 3]), found),
        (state, weight, np.array([3, 1]), found),
    ):
        with pytest.raises(ValueError, match=r"shape|counts"):
            medians.COMPILED.medians(*given)
