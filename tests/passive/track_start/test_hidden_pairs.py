"""Two sources nearer than the array resolves are found, and a single one is not taken for two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.track_start.hidden_pairs import PairFit, hidden_pair, new_pair
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER

N_SNAPSHOTS = 100
SECOND = 1_000_000_000


def covariance_of(
    angles_deg: tuple[float, ...], levels_db: tuple[float, ...], seed: int, wrong: float = 0.0
) -> ComplexArray:
    generator = np.random.default_rng(seed)

    def normal(*shape: int) -> ComplexArray:
        pairs = generator.standard_normal((*shape, 2)) / np.sqrt(2.0)
        return np.asarray(pairs[..., 0] + 1j * pairs[..., 1], dtype=np.complex128)

    steering = steering_vectors(POSITIONS, np.radians(angles_deg), WAVENUMBER)
    steering = steering * (1.0 + wrong * normal(len(POSITIONS), 1))
    signals = 10.0 ** (np.array(levels_db) / 20.0) * normal(N_SNAPSHOTS, len(angles_deg))
    data = signals @ steering.T + normal(N_SNAPSHOTS, len(POSITIONS))
    return np.asarray(data.T @ data.conj() / N_SNAPSHOTS, dtype=np.complex128)


def estimates_of(covariance: ComplexArray) -> SubspaceEstimates:
    number = 1500.0 * WAVENUMBER / (2.0 * np.pi)
    return SubspaceEstimates(
        stamp=0,
        method="covariance",
        basis=np.empty((0, len(POSITIONS), 1), dtype=np.complex128),
        time_offsets=np.empty(0),
        element_positions=POSITIONS,
        sample_period=0.005,
        center_frequency=number,
        bandwidth=100.0,
        sound_speed=1500.0,
        effective_snapshots=10.0,
        covariance=covariance,
        covariance_snapshots=N_SNAPSHOTS,
        covariance_time_offset=0.0,
        noise_power=np.array(1.0),
    )


def found(
    covariance: ComplexArray, tracks_deg: FloatArray, n_sources: int, rate_deg: float = 0.0
) -> PairFit | None:
    rates = np.full(len(tracks_deg), np.radians(rate_deg))
    tracks = np.radians(tracks_deg)
    return hidden_pair(estimates_of(covariance), covariance, n_sources, tracks, rates)


def test_both_of_a_pair_are_found_within_their_deviations() -> None:
    for seed in range(5):
        fit = found(covariance_of((10.0, 13.0), (0.0, 0.0), seed), np.array([11.5]), 2)
        assert fit is not None and fit.row == 0
        errors = np.degrees(fit.angles) - [10.0, 13.0]
        assert np.all(np.abs(errors) < 4.0 * np.degrees(np.sqrt(fit.variances)))
        assert np.all(np.degrees(np.sqrt(fit.variances)) < 0.5)


def test_the_track_that_hides_two_is_found_among_others() -> None:
    scene = covariance_of((-40.0, 10.0, 13.0, 50.0), (3.0, 0.0, 3.0, 0.0), 7)
    fit = found(scene, np.array([-40.0, 50.0, 12.0]), 4)
    assert fit is not None and fit.row == 2


def test_a_second_source_elsewhere_is_no_pair() -> None:
    scene = covariance_of((10.0, 30.0), (0.0, 0.0), 8)
    assert found(scene, np.array([10.0]), 2) is None


def test_what_errors_of_the_array_leave_of_one_source_is_no_pair() -> None:
    for seed in range(5):
        scene = covariance_of((10.0,), (20.0,), seed, wrong=0.1)
        assert found(scene, np.array([10.0]), 2) is None


def test_lines_start_once_they_are_apart_and_not_before() -> None:
    def pair(low: float, high: float, deviation: float) -> PairFit:
        angles = np.radians([low, high])
        return PairFit(0, angles, np.full(2, np.radians(deviation) ** 2), 0.0)

    clear, vague = (new_pair(7, 9, 0, pair(10.0, 13.0, deviation)) for deviation in (0.3, 2.0))
    for second in range(1, 5):
        assert not clear.resolved(second * SECOND) or second > 3
        clear = clear.add(second * SECOND, pair(10.0, 13.0, 0.3))
        vague = vague.add(second * SECOND, pair(10.0, 13.0, 2.0))
    assert clear.resolved(4 * SECOND) and not vague.resolved(4 * SECOND)
    assert np.degrees(clear.half_separation()) == pytest.approx(1.5)
    assert [side.id for side in clear.sides] == [7, 9]


def test_pairs_that_do_not_come_again_are_given_up() -> None:
    pair = new_pair(1, 2, 0, PairFit(0, np.array([0.0, 0.1]), np.full(2, 1e-4), 0.0))
    for _ in range(3):
        missed = pair.missed()
        assert missed is not None
        pair = missed
    assert pair.missed() is None
    assert replace(pair, misses=0).missed() is not None


def test_what_a_source_looks_like_that_turns_during_the_snapshots_is_no_pair() -> None:
    scene = covariance_of((10.0, 11.0), (17.0, 17.0), 11)
    assert found(scene, np.array([10.5]), 2) is not None
    # 100 snapshots take half a second: a source that turns by 1.75 deg looks like these two.
    assert found(scene, np.array([10.5]), 2, 3.5) is None
