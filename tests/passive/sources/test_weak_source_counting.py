"""Counting on the mean of successive covariances: weak sources, never the motion of strong ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.passive.sources.weak_source_counting import (
    WeakSourceCounter,
    believed_sources,
    least_ratios,
)
from sonar_tracking.records.bearings import SubspaceEstimates
from tests.passive.block_scene import noise_colour, noise_from_ahead
from tests.passive.crossing_scene import (
    FREQUENCY,
    POSITIONS,
    SAMPLE_PERIOD,
    SOUND_SPEED,
    WAVENUMBER,
    ComplexArray,
    circular_noise,
    snapshots_of,
)
from tests.passive.estimate_scene import estimates_of

FIVE = np.deg2rad([-50.0, -25.0, 0.0, 25.0, 50.0])
N = 100
FASTEST = np.deg2rad(5.0)


def counted(
    data: ComplexArray,
    noise_covariance: ComplexArray | None = None,
    together: int = 4,
    fastest: float = FASTEST,
) -> list[int]:
    """Return the count after each covariance of a hundred snapshots."""
    estimates = SubspaceEstimates(
        stamp=0,
        method="covariance",
        basis=np.empty((0, len(POSITIONS), 1), dtype=complex),
        time_offsets=np.empty(0),
        element_positions=POSITIONS,
        sample_period=SAMPLE_PERIOD,
        center_frequency=FREQUENCY,
        bandwidth=10.0,
        sound_speed=SOUND_SPEED,
        effective_snapshots=N,
        covariance_snapshots=N,
        noise_covariance=noise_covariance,
    )
    counter, counts = WeakSourceCounter(counted_together=together), []
    for number, block in enumerate(data.reshape(-1, N, len(POSITIONS))):
        middle = round(number * N * SAMPLE_PERIOD * 1e9)
        counter = counter.add(middle, sample_covariance(block))
        counts.append(counter.count(estimates, fastest))
    return counts


def test_weak_sources_are_counted_where_one_covariance_does_not_show_them() -> None:
    generator = np.random.default_rng(1)
    counts = [
        counted(snapshots_of(generator, np.broadcast_to(FIVE, (4 * N, 5)), -10.0))
        for _ in range(10)
    ]
    first, last = np.array(counts)[:, 0], np.array(counts)[:, -1]
    assert first.mean() < 1.0
    assert last.mean() > 4.0
    assert last.max() == 5


@pytest.mark.parametrize("level_db", [-5.0, 0.0, 10.0, 20.0, 30.0])
def test_moving_sources_are_never_counted_twice(level_db: float) -> None:
    generator = np.random.default_rng(2)
    turn = FASTEST * np.arange(8 * N)[:, None] * SAMPLE_PERIOD
    moving = FIVE + turn * np.array([1, -1, 1, -1, 1])
    for _ in range(5):
        assert max(counted(snapshots_of(generator, moving, level_db))) <= 5


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_noise_alone_is_no_source(correlation: float) -> None:
    colour = noise_colour(correlation)
    data = circular_noise(np.random.default_rng(3), 100 * N, 15) @ np.linalg.cholesky(colour).T
    assert max(counted(data, colour if correlation else None)) == 0


def test_only_the_newest_that_are_counted_on_are_kept() -> None:
    for together, kept in ((None, (5, 6, 7, 8)), (1, (8,)), (3, (6, 7, 8)), (16, tuple(range(9)))):
        counter = (
            WeakSourceCounter()
            if together is None
            else WeakSourceCounter(counted_together=together)
        )
        for number in range(9):
            counter = counter.add(number, np.full((2, 2), number, dtype=complex))
        assert counter.middles == kept


@pytest.mark.slow
def test_longer_means_show_weaker_sources_where_none_moves_fast() -> None:
    generator = np.random.default_rng(4)
    data = [snapshots_of(generator, np.broadcast_to(FIVE, (16 * N, 5)), -12.0) for _ in range(5)]
    slow = np.deg2rad(0.05)
    last = {n: np.mean([counted(d, None, n, slow)[-1] for d in data]) for n in (1, 4, 16)}
    assert last[1] < 0.5 < last[4] < 4.5 < last[16]
    fast = [counted(d, None, 16, FASTEST)[-1] for d in data]
    assert fast == [counted(d, None, 4, FASTEST)[-1] for d in data], "the long mean is not believed"


def test_a_covariance_by_itself_is_not_helped_by_those_before() -> None:
    generator = np.random.default_rng(5)
    data = snapshots_of(generator, np.broadcast_to(FIVE, (4 * N, 5)), -9.0)
    alone = [counted(block, together=1)[0] for block in data.reshape(4, N, -1)]
    assert alone == counted(data, together=1)


def test_what_motion_may_have_spread_is_not_believed_by_hand() -> None:
    # The strongest, 10, spreads at this turn to p = 10 (k d)^2 var(x) / 12 = 0.45; 2 p = 0.9 would
    # show as 1.9 (1 + 0.0375 / 0.9) = 1.98.
    values = np.array([10.0, 3.0, 1.9, *np.ones(12)])
    variance = float(POSITIONS[:, 0].var())
    turn = np.sqrt(0.45 * 12.0 / 10.0 / variance) / WAVENUMBER
    assert believed_sources(values, 4 * N, POSITIONS, WAVENUMBER, 0.0) == 3
    assert believed_sources(values, 4 * N, POSITIONS, WAVENUMBER, turn) == 2
    assert believed_sources(values, 4 * N, POSITIONS, WAVENUMBER, 2.0 * turn) == 0


def test_the_unit_of_power_does_not_count() -> None:
    values = np.array([10.0, 3.0, 1.9, *np.ones(12)])
    for unit in (1e-30, 1e-12, 1e12):
        assert believed_sources(unit * values, 4 * N, POSITIONS, WAVENUMBER, 0.0) == 3


def turn_that_spreads(ratio: float, spread: float) -> float:
    """Return the turn by which the strongest source spreads to a second eigenvalue."""
    variance = float(POSITIONS[:, 0].var())
    return float(np.sqrt(spread * 12.0 / ratio / variance) / WAVENUMBER)


@pytest.mark.parametrize(
    ("spread", "counted_sources"),
    [
        (0.09, 3),  # 2 * 0.09 is hidden in the random spread, sqrt(15 / 400) = 0.194
        (0.40, 3),  # 1.8 (1 + 0.0375 / 0.8) = 1.88
        (0.42, 2),  # 1.84 (1 + 0.0375 / 0.84) = 1.92
        (0.49, 2),  # 1.98 (1 + 0.0375 / 0.98) = 2.06
        (0.51, 0),  # 2 * 0.51 exceeds the noise: nothing is believed
    ],
)
def test_believed_is_what_exceeds_twice_the_spread_of_motion(
    spread: float, counted_sources: int
) -> None:
    values = np.array([10.0, 3.0, 1.9, *np.ones(12)])
    turn = turn_that_spreads(10.0, spread)
    assert believed_sources(values, 400, POSITIONS, WAVENUMBER, turn) == counted_sources


def test_an_array_that_is_no_line_needs_two_snapshots_an_element() -> None:
    bent = POSITIONS.copy()
    bent[7, 1] = 0.3
    vector = steering_vectors(bent, np.array([0.3]), WAVENUMBER)
    covariance = 20.0 * vector @ vector.conj().T + np.eye(15)
    estimates = SubspaceEstimates(
        stamp=0,
        method="covariance",
        basis=np.empty((0, 15, 1), dtype=complex),
        time_offsets=np.empty(0),
        element_positions=bent,
        sample_period=SAMPLE_PERIOD,
        center_frequency=FREQUENCY,
        bandwidth=10.0,
        sound_speed=SOUND_SPEED,
        effective_snapshots=N,
    )
    counter = WeakSourceCounter().add(0, covariance)
    for n_snapshots, expected in [(29, 0), (30, 1)]:
        known = replace(estimates, covariance_snapshots=n_snapshots)
        assert counter.count(known, 0.0) == expected
    # Two covariances that share no snapshots have as many together.
    both = counter.add(1_000_000_000, covariance)
    assert both.count(replace(estimates, covariance_snapshots=15), 0.0) == 1


def test_noise_from_ahead_is_no_source() -> None:
    noise = noise_from_ahead()
    counter = WeakSourceCounter().add(0, 2.0 * noise)
    assert counter.count(estimates_of(None, covariance_snapshots=N), 0.0) > 0
    known = estimates_of(None, covariance_snapshots=N, noise_covariance=noise)
    assert counter.count(known, 0.0) == 0


def test_a_covariance_of_another_array_begins_anew() -> None:
    counter = WeakSourceCounter().add(1, np.eye(3, dtype=complex)).add(2, np.eye(3, dtype=complex))
    assert counter.add(3, np.eye(4, dtype=complex)).middles == (3,)


@pytest.mark.parametrize("level_db", [-20.0, -5.0, 10.0, 30.0])
def test_no_eigenvalues_are_needed_where_trace_and_norm_say_enough(level_db: float) -> None:
    """The ratio they allow is below that of the eigenvalues, however many are taken for noise."""
    generator = np.random.default_rng(6)
    data = snapshots_of(generator, np.broadcast_to(FIVE[:3], (N, 3)), level_db)
    covariance = sample_covariance(data)
    values = np.linalg.eigvalsh(covariance)[::-1]
    least = float(least_ratios(covariance[None])[0])
    assert 1.0 <= least <= min(values[0] / values[k:].mean() for k in range(1, 15))
