"""Protects on how many snapshots sources are counted: as many as their own motion allows."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.sources.mdl import counting_snapshots, source_count
from sonar_tracking.passive.sources.moving_source_counting import (
    _largest_turn,
    count_moving_sources,
    sample_covariance,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from tests.passive.crossing_scene import (
    POSITIONS,
    SAMPLE_PERIOD,
    WAVENUMBER,
    block_of,
    circular_noise,
    snapshots_of,
)

HEADER = block_of(np.empty((0, 15), complex), 0)
FASTEST = np.radians(5.0)


def eigenvalues(data: ComplexArray) -> FloatArray:
    return np.asarray(np.linalg.eigvalsh(sample_covariance(data))[::-1])


def counted(data: ComplexArray, thorough: bool, fastest: float = FASTEST) -> int:
    covariance = sample_covariance(data)
    counted = count_moving_sources(data, covariance, eigenvalues(data), HEADER, fastest, thorough)
    return int(counted)


def strong_and_weak(seed: int, rate_deg: float = 0.0) -> ComplexArray:
    """Return a strong source that may turn, and a weak one that only many snapshots show."""
    generator = np.random.default_rng(seed)
    angles = np.stack([np.full(200, -0.4), np.full(200, 0.3)], axis=1)
    angles[:, 0] += np.radians(rate_deg) * SAMPLE_PERIOD * np.arange(200)
    return snapshots_of(generator, angles, [25.0, -6.0])


def test_too_few_snapshots_are_not_counted_on() -> None:
    data = strong_and_weak(1)
    assert counted(data[:11], True) == -1
    assert counted(data[:12], True) >= 1


def test_the_first_count_is_on_the_newest_that_the_fastest_allow() -> None:
    data = strong_and_weak(2)
    used = counting_snapshots(
        eigenvalues(data), 200, POSITIONS, WAVENUMBER, FASTEST * SAMPLE_PERIOD
    )
    assert used < 50
    expected = source_count(sample_covariance(data[-used:]), int(used))
    assert counted(data, thorough=False) == expected


def test_more_are_counted_on_where_the_strong_ones_stand_still() -> None:
    still = [counted(strong_and_weak(seed), True) for seed in range(3, 13)]
    hasty = [counted(strong_and_weak(seed), False) for seed in range(3, 13)]
    assert np.mean(still) > 1.7
    assert np.mean(hasty) < 1.3
    # One that turns as fast as allowed is counted once, and hides the weak one.
    turning = [counted(strong_and_weak(seed, 5.0), True) for seed in range(3, 13)]
    assert max(turning) <= 2
    assert np.mean(turning) < 1.3


def test_where_none_is_seen_twice_as_many_are_looked_at() -> None:
    """A weak source beside noise whose strongest eigenvalue allows but a few snapshots."""
    generator = np.random.default_rng(4)
    weak = snapshots_of(generator, np.broadcast_to([0.3], (200, 1)), -7.0)
    assert counted(weak, thorough=False, fastest=np.radians(60.0)) == 1
    noise = circular_noise(generator, 200, 15)
    assert counted(noise, thorough=True, fastest=np.radians(60.0)) == 0


def test_the_turn_is_between_halves_of_equal_length() -> None:
    """Of five snapshots the one in the middle belongs to neither half, however strong it is."""
    angles = np.array([[0.1], [0.1], [-0.9], [0.13], [0.13]])
    data = steering_vectors(POSITIONS, angles, WAVENUMBER)[..., 0]
    data[2] *= 100.0
    assert _largest_turn(data, 1, POSITIONS, WAVENUMBER, None) == pytest.approx(0.01, abs=1e-6)
