"""Counting sources: the criterion itself, coherent sources, strong sources that move."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.sources.mdl import (
    counting_snapshots,
    minimum_description_length,
    smoothed_size,
    source_count,
)
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.passive.sources.spatial_smoothing import forward_backward_smoothed
from sonar_tracking.passive.subspaces.covariance_summary import summarise_windows
from tests.passive.block_scene import noise_from_ahead
from tests.passive.crossing_scene import (
    POSITIONS,
    SAMPLE_PERIOD,
    WAVENUMBER,
    block_of,
    circular_noise,
    snapshots_of,
)

FIVE = np.deg2rad([-50.0, -25.0, 0.0, 25.0, 50.0])


def test_criterion_by_hand() -> None:
    # Three eigenvalues, N = 100: MDL(0) = 300 ln(2/1.26), MDL(1) = 0 + 2.5 ln 100, MDL(2) larger.
    assert minimum_description_length(np.array([4.0, 1.0, 1.0]), 100) == 1
    assert minimum_description_length(np.array([1.0, 1.0, 1.0]), 100) == 0
    assert minimum_description_length(np.array([9.0, 4.0, 1.0]), 100) == 2


@pytest.mark.parametrize("above", [[], [50.0], [80.0, 50.0]])
def test_the_penalty_is_that_of_the_free_parameters(above: list[float]) -> None:
    """A pair exp(+-x) above which all is signal: is its first one signal as well, by hand.

    Counting it takes away the misfit 2 N ln cosh x and adds half of the free parameters of one
    more signal eigenvalue, k(2M - k) of k less those of k - 1: 2M - 2k + 1 = 3 whatever M, as
    k = M - 1. With N = 100 both are equal at ln cosh x = 1.5 ln(100) / 200: x = 0.264.
    """
    for x, counted in [(0.260, 0), (0.268, 1)]:
        eigenvalues = np.array([*above, np.exp(x), np.exp(-x)])
        assert minimum_description_length(eigenvalues, 100) == len(above) + counted


def test_degenerate_spectra_do_not_fail() -> None:
    assert minimum_description_length(np.zeros(5), 100) == 0
    assert minimum_description_length(np.array([1.0, 1.0, 0.0, 0.0]), 2) in (0, 1)


def test_smoothing_by_hand() -> None:
    covariance = np.arange(9.0).reshape(3, 3).astype(complex)
    covariance = covariance + covariance.T
    smoothed = forward_backward_smoothed(covariance, 2)
    direct = 0.5 * (covariance[:2, :2] + covariance[1:, 1:])
    exchanged = direct[::-1, ::-1].conj()
    assert np.allclose(smoothed, 0.5 * (direct + exchanged))


@pytest.mark.parametrize("level_db", [-5.0, 0.0, 10.0])
def test_separated_sources_are_all_counted(level_db: float) -> None:
    generator = np.random.default_rng(1)
    for _ in range(10):
        data = snapshots_of(generator, np.broadcast_to(FIVE, (200, 5)), level_db)
        covariance = sample_covariance(data)
        raw = minimum_description_length(np.linalg.eigvalsh(covariance)[::-1], 200)
        assert raw == source_count(covariance, 200) == 5


def test_coherent_sources_are_one_in_rank_but_two_in_number() -> None:
    generator = np.random.default_rng(2)
    vectors = steering_vectors(POSITIONS, np.deg2rad([-10.0, 15.0]), WAVENUMBER)
    common = circular_noise(generator, 100, 1)
    data = common * (vectors @ np.array([1.0, np.exp(1j)])) + circular_noise(generator, 100, 15)
    summary = summarise_windows(data[None], 0, block_of(data[:0], 0), None, 0.0)[0]
    assert (summary.rank, summary.source_count) == (1, 2)
    assert summary.noise_power == pytest.approx(1.0, rel=0.15)


@pytest.mark.parametrize("level_db", [10.0, 20.0])
def test_strong_moving_sources_are_counted_once(level_db: float) -> None:
    # At 3 deg/s and 20 dB the whole second of data shows nine sources.
    generator = np.random.default_rng(3)
    turn = np.deg2rad(3.0) * np.arange(100)[:, None] * SAMPLE_PERIOD
    moving = FIVE + turn * np.array([1, -1, 1, -1, 1])
    for _ in range(10):
        data = snapshots_of(generator, moving, level_db)
        summary = summarise_windows(data[None], 0, block_of(data[:0], 0), None, np.deg2rad(5.0))[0]
        assert summary.source_count == 5


def test_weak_sources_are_seen_beside_strong_ones() -> None:
    # The strong one stands still: all snapshots may be used, and the weak ones are found.
    generator = np.random.default_rng(4)
    static = np.broadcast_to(FIVE, (100, 5))
    for _ in range(10):
        data = snapshots_of(generator, static, [20.0, -3.0, -3.0, -3.0, -3.0])
        summary = summarise_windows(data[None], 0, block_of(data[:0], 0), None, np.deg2rad(5.0))[0]
        assert summary.source_count == 5


@pytest.mark.parametrize("n_elements", [32, 128])
def test_large_arrays_count_on_few_snapshots(n_elements: int) -> None:
    generator = np.random.default_rng(5)
    positions = line_array(n_elements, 0.5)
    for angles, expected in [(FIVE, 5), (FIVE[:0], 0)]:
        static = np.broadcast_to(angles, (100, len(angles)))
        data = snapshots_of(generator, static, 0.0, positions=positions)
        header = block_of(data[:0], 0, element_positions=positions)
        summary = summarise_windows(data[None], 0, header, None, np.deg2rad(5.0))[0]
        assert summary.source_count == expected


def test_weak_sources_use_all_snapshots() -> None:
    eigenvalues = np.array([2.0] + [1.0] * 14)
    turn = np.deg2rad(5.0) * SAMPLE_PERIOD
    assert counting_snapshots(eigenvalues, 60, POSITIONS, WAVENUMBER, turn) == 60
    strong = np.array([2000.0] + [1.0] * 14)
    assert counting_snapshots(strong, 60, POSITIONS, WAVENUMBER, turn) < 20
    assert counting_snapshots(strong, 60, POSITIONS, WAVENUMBER, 0.0) == 60


def test_the_unit_of_power_does_not_count() -> None:
    values = np.array([9.0, 4.0, 1.02, 1.0, 0.98])
    for unit in (1e-30, 1e-12, 1e12):
        assert minimum_description_length(unit * values, 100) == 2
    padded = np.append(values, 0.0)
    for unit in (1e-30, 1.0, 1e12):
        assert minimum_description_length(unit * padded, 100) == 2


def test_eigenvalues_that_fewer_snapshots_cannot_fill_are_left_out() -> None:
    # Of three: 9 ln((11 / 3) / 9^(1/3)) = 5.1 for none, 2.5 ln 3 = 2.7 for one.
    assert minimum_description_length(np.array([9.0, 1.0, 1.0, 0.0, 0.0, 0.0]), 3) == 1
    # Numbers at the level of rounding are no noise either.
    rounding = 9.0 * np.finfo(float).eps * np.array([1.0, 0.5, 0.2])
    assert minimum_description_length(np.array([9.0, 1.0, 1.0, *rounding]), 3) == 1


@pytest.mark.parametrize("n_smoothed", [1, 2, 4, 6, 7])
def test_smoothing_is_the_mean_over_all_sub_arrays_both_ways(n_smoothed: int) -> None:
    generator = np.random.default_rng(6)
    root = circular_noise(generator, 7, 7)
    covariance = root @ root.conj().T
    exchange = np.eye(n_smoothed)[::-1]
    expected = np.zeros((n_smoothed, n_smoothed), complex)
    n_arrays = 7 - n_smoothed + 1
    for first in range(n_arrays):
        own = covariance[first : first + n_smoothed, first : first + n_smoothed]
        expected += 0.5 * (own + exchange @ own.conj() @ exchange) / n_arrays
    assert np.allclose(forward_backward_smoothed(covariance, n_smoothed), expected)


@pytest.mark.parametrize(
    ("n_elements", "n_snapshots", "size"),
    [
        (15, 200, 10),  # two thirds
        (16, 200, 11),
        (15, 3, 6),  # 6^2 <= 15 * 3
        (2, 1, 2),
        (300, 10_000, 128),
    ],
)
def test_sub_arrays_are_two_thirds_or_what_the_data_allow(
    n_elements: int, n_snapshots: int, size: int
) -> None:
    assert smoothed_size(n_elements, n_snapshots) == size


def allowed_by_hand(ratio: float, turn: float) -> int:
    """Solve ratio (k d)^2 var(x) / 12 = sqrt(M / N) / 2 for N, with d = N turn."""
    variance = float(np.mean((POSITIONS[:, 0] - np.mean(POSITIONS[:, 0])) ** 2))
    return int((6.0 * np.sqrt(15.0) / (WAVENUMBER**2 * variance * turn**2 * ratio)) ** 0.4)


@pytest.mark.parametrize("turn_deg", [0.03, 0.02, 0.01])
def test_snapshots_that_a_moving_source_allows_by_hand(turn_deg: float) -> None:
    turn = np.radians(turn_deg)
    # The noise is the mean of the last third: 0.5; the first is 40 times as strong.
    values = np.array([20.0, *np.full(9, 3.0), 0.7, 0.6, 0.5, 0.4, 0.3])
    expected = allowed_by_hand(40.0, turn)
    assert 12 < expected < 200
    assert counting_snapshots(values, 200, POSITIONS, WAVENUMBER, turn) == expected
    assert counting_snapshots(values, 20, POSITIONS, WAVENUMBER, turn) == 20
    # Of 6 snapshots there are 6 eigenvalues, and noise in the last two of them.
    few = np.array([20.0, 3.0, 3.0, 3.0, 0.6, 0.4, *np.zeros(9)])
    assert counting_snapshots(few, 6, POSITIONS, WAVENUMBER, turn) == 6
    # The unit of power does not count, with and without noise.
    silent = np.array([20.0, 3.0, *np.zeros(13)])
    for each in (values, silent):
        allowed = {
            counting_snapshots(unit * each, 200, POSITIONS, WAVENUMBER, turn)
            for unit in (1e-20, 1.0, 1e12)
        }
        assert len(allowed) == 1


def test_a_dozen_snapshots_are_counted_on_whatever_moves() -> None:
    strong = np.array([1e8, *np.ones(14)])
    assert counting_snapshots(strong, 200, POSITIONS, WAVENUMBER, np.radians(1.0)) == 12
    assert counting_snapshots(strong, 7, POSITIONS, WAVENUMBER, np.radians(1.0)) == 7
    # Without any noise the ratio is taken for 90 dB.
    silent = np.array([1.0, *np.zeros(14)])
    turn = 1e-7
    assert counting_snapshots(silent, 200, POSITIONS, WAVENUMBER, turn) == allowed_by_hand(
        1e9, turn
    )


def test_noise_of_a_known_colour_is_no_source() -> None:
    generator = np.random.default_rng(7)
    distance = np.abs(np.subtract.outer(np.arange(15), np.arange(15)))
    colour = (0.9**distance).astype(complex)
    data = circular_noise(generator, 400, 15) @ np.linalg.cholesky(colour).T
    covariance = sample_covariance(data)
    assert source_count(covariance, 400, colour) == 0
    assert source_count(covariance, 400) > 0
    white = sample_covariance(snapshots_of(generator, np.broadcast_to(FIVE, (200, 5)), 0.0))
    assert source_count(white, 200, np.eye(15, dtype=complex)) == source_count(white, 200) == 5


def test_noise_from_ahead_is_no_source() -> None:
    """Its covariance is complex; a source in it, 15 times above it, is one."""
    noise = noise_from_ahead()
    vector = steering_vectors(POSITIONS, np.array([-0.5]), WAVENUMBER)
    assert source_count(noise, 100) > 0
    assert source_count(noise, 100, noise) == 0
    assert source_count(noise + vector @ vector.conj().T, 100, noise) == 1


def test_smoothing_loses_no_weak_power() -> None:
    covariance = np.diag([1.0, 2.0, 5.0]).astype(complex)
    weak = forward_backward_smoothed(np.multiply(1e-20, covariance, dtype=np.complex128), 2)
    # Means 1.5 and 3.5 along the diagonal, and both ways 2.5.
    np.testing.assert_allclose(weak, 2.5e-20 * np.eye(2), rtol=1e-12)
