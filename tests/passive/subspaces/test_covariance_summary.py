"""Protects what is said of a covariance: its eigenvalues, its noise, and when it is silent."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.subspaces.covariance_summary import (
    CovarianceSummary,
    summarise_windows,
)
from sonar_tracking.records.arrays import ComplexArray
from tests.passive.crossing_scene import POSITIONS, block_of, circular_noise, snapshots_of

DATA = snapshots_of(np.random.default_rng(1), np.broadcast_to([-0.3, 0.4], (200, 2)), 20.0)


def summary(data: ComplexArray, n_columns: int = 2, bent: bool = False) -> CovarianceSummary:
    positions = POSITIONS.copy()
    positions[7, 1] += 0.2 if bent else 0.0
    header = block_of(data[..., :0, :], 0, element_positions=positions)
    return summarise_windows(data[None], n_columns, header, None, 0.0)[0]


def test_eigenvalues_fall_and_the_noise_is_the_mean_of_those_left() -> None:
    found = summary(DATA)
    covariance = DATA.T @ DATA.conj() / 200
    values = np.linalg.eigvalsh(covariance)[::-1]
    assert found.covariance == pytest.approx(covariance)
    assert found.eigenvalues == pytest.approx(values)
    assert found.noise_power == pytest.approx(np.mean(values[2:]))
    assert summary(DATA, 5).noise_power == pytest.approx(np.mean(values[5:]))
    assert (found.rank, found.source_count, found.n_snapshots) == (2, 2, 200)
    assert summary(DATA, 0).noise_power == pytest.approx(np.mean(values[2:])), "as MDL finds"


@pytest.mark.parametrize("n_snapshots", [1, 5, 14, 15, 16])
def test_few_snapshots_have_the_eigenvalues_of_their_covariance(n_snapshots: int) -> None:
    data = DATA[:n_snapshots]
    values = np.linalg.eigvalsh(data.T @ data.conj() / n_snapshots)[::-1]
    assert summary(data).eigenvalues == pytest.approx(values, abs=1e-9 * values[0])


def test_noise_is_unknown_where_nothing_is_left_of_it() -> None:
    assert np.isnan(summary(DATA[:2]).noise_power)
    assert np.isfinite(summary(DATA[:3]).noise_power)
    assert np.isnan(summary(DATA, 15).noise_power)
    assert np.isfinite(summary(DATA, 14).noise_power)


def test_rank_needs_two_snapshots_an_element_and_a_count_a_dozen() -> None:
    strong = snapshots_of(np.random.default_rng(2), np.broadcast_to([0.1], (60, 1)), 30.0)
    assert [summary(strong[:n]).rank for n in (29, 30)] == [-1, 1]
    assert [summary(strong[:n]).source_count for n in (11, 12)] == [-1, 1]
    bent = summary(strong, bent=True)
    assert (bent.rank, bent.source_count) == (1, -1), "only uniform lines can be smoothed"


def test_a_batch_has_its_noise_and_no_counts() -> None:
    batch = circular_noise(np.random.default_rng(3), 4, 50, 15)
    found = summary(batch)
    assert (found.rank, found.source_count) == (-1, -1)
    alone = [summary(run) for run in batch]
    assert found.noise_power == pytest.approx([float(each.noise_power) for each in alone])
    assert found.eigenvalues == pytest.approx(np.stack([each.eigenvalues for each in alone]))
    assert np.isnan(summary(batch, 15).noise_power).tolist() == [True] * 4


def test_no_snapshots_say_nothing() -> None:
    nothing = summary(DATA[:0])
    assert nothing.covariance is None
    assert nothing.n_snapshots == 0
    assert np.isnan(nothing.noise_power)
