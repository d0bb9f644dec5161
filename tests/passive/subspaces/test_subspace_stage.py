"""The subspace stage: windows, batches, gaps, rejected blocks, end of data."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError, InputError, Notice
from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.subspaces.past import Past
from sonar_tracking.passive.subspaces.subspace_method_registry import SUBSPACE_METHODS
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import END_OF_DATA
from tests.passive.crossing_scene import (
    EPOCH,
    POSITIONS,
    WAVENUMBER,
    block_of,
    blocks_of,
    circular_noise,
    crossing_data,
)

SECOND = 1_000_000_000
PAPER = SubspaceConfiguration(
    method="past", forgetting_factor=0.86, period=1.0, source_count=5, n_subspaces=7
)


def fed(
    stage: SubspaceStage, blocks: list[ArraySnapshots]
) -> tuple[list[SubspaceEstimates], list[Notice]]:
    """Return all estimates and notices of the blocks."""
    estimates: list[SubspaceEstimates] = []
    notices: list[Notice] = []
    for block in blocks:
        update = stage.update(block)
        estimates += update.estimates
        notices += update.notices
    return estimates, notices


def test_subspaces_are_those_around_the_sample_time() -> None:
    # PAST from the first snapshot; subspaces after snapshots 200 k - 3 ... 200 k + 3.
    data = crossing_data(1, 0.0, 2.0)
    estimates, notices = fed(SubspaceStage(PAPER), list(blocks_of(data)))
    assert notices == []
    assert [e.stamp - EPOCH for e in estimates] == [0, SECOND, 2 * SECOND]
    method = Past(0.86)
    for estimate in estimates:
        centre = 200 + (estimate.stamp - EPOCH) * 200 // SECOND
        for number, offset in enumerate(range(-3, 4)):
            state = method.update(method.start(15, 5), data[: centre + offset + 1])
            assert np.abs(estimate.basis[number] - state.basis).max() < 1e-12
        assert estimate.time_offsets == pytest.approx(np.arange(-3, 4) / 200.0, abs=1e-12)
        last = data[centre + 1 - 100 : centre + 1]
        assert estimate.covariance is not None
        assert np.allclose(estimate.covariance, last.T @ last.conj() / 100)
        assert estimate.covariance_time_offset == pytest.approx(-49.5 / 200.0)
        assert estimate.next_stamp == estimate.stamp + SECOND
        assert estimate.effective_snapshots == pytest.approx(1.86 / 0.14)


def test_the_first_covariance_holds_what_has_come_and_nothing_else() -> None:
    data = crossing_data(1, 0.0, 1.0)
    stage = SubspaceStage(replace(PAPER, covariance_snapshots=1000))
    estimates, _ = fed(stage, list(blocks_of(data)))
    first = estimates[0]
    assert first.covariance_snapshots == 201 and first.covariance is not None
    assert np.allclose(first.covariance, data[:201].T @ data[:201].conj() / 201)


@pytest.mark.parametrize("method", ["past", "opast", "block_past", "covariance"])
@pytest.mark.parametrize("rate", [200.0, 160.0, 93.75])
def test_windows_do_not_depend_on_the_blocks(method: str, rate: float) -> None:
    data = circular_noise(np.random.default_rng(2), round(4 * rate), 15)
    configuration = replace(PAPER, method=method, update_snapshots=7)
    results = []
    for size in (1 + len(data), 33, 20):
        blocks = list(blocks_of(data, size, period=1.0 / rate))
        results.append(fed(SubspaceStage(configuration), blocks)[0])
    for other in results[1:]:
        assert [e.stamp for e in other] == [e.stamp for e in results[0]]
        for first, second in zip(results[0], other, strict=True):
            assert np.abs(first.basis - second.basis).max() < 1e-9
            assert np.allclose(first.time_offsets, second.time_offsets, atol=2e-9)
    step = 1 if SUBSPACE_METHODS[method].snapshot_by_snapshot else 7
    for estimate in results[0]:
        assert len(estimate.time_offsets) == 7
        assert np.diff(estimate.time_offsets) == pytest.approx(np.full(6, step / rate), abs=1e-9)
        assert abs(estimate.time_offsets[3]) <= (0.5 * step + 0.51) / rate


@pytest.mark.parametrize(
    ("alignment", "n_snapshots", "before"),
    [("causal", 150, 149), ("centred", 151, 75), ("centred", 150, 74)],
)
@pytest.mark.parametrize("size", [20, 37, 500])
@pytest.mark.parametrize("n_subspaces", [1, 7])
def test_covariance_ends_at_the_sample_time_or_lies_around_it(
    alignment: str, n_snapshots: int, before: int, size: int, n_subspaces: int
) -> None:
    data = crossing_data(17, 0.0, 3.0)
    configuration = SubspaceConfiguration(
        period=1.0,
        source_count=5,
        n_subspaces=n_subspaces,
        covariance_snapshots=n_snapshots,
        covariance_alignment=alignment,
    )
    estimates, _ = fed(SubspaceStage(configuration), list(blocks_of(data, size)))
    in_reach = (0, SECOND, 2 * SECOND)
    assert tuple(e.stamp - EPOCH for e in estimates if e.stamp < EPOCH + 3 * SECOND) == in_reach
    for estimate in estimates[:3]:
        first = 200 + (estimate.stamp - EPOCH) * 200 // SECOND - before
        part = data[first : first + n_snapshots]
        assert estimate.covariance is not None
        assert estimate.covariance_snapshots == n_snapshots
        assert np.allclose(estimate.covariance, part.T @ part.conj() / n_snapshots)
        middle = (0.5 * (n_snapshots - 1) - before) / 200.0
        assert estimate.covariance_time_offset == pytest.approx(middle, abs=1e-12)
        newest = max(n_snapshots - 1 - before, (n_subspaces - 1) // 2 * 10) / 200.0
        assert estimate.newest_offset == pytest.approx(newest, abs=1e-12)


def test_centred_covariance_cut_off_by_a_gap_lies_before_it() -> None:
    blocks = list(blocks_of(crossing_data(18, 0.0, 3.0)))
    configuration = SubspaceConfiguration(
        period=1.0,
        source_count=5,
        n_subspaces=1,
        covariance_snapshots=100,
        covariance_alignment="centred",
    )
    # The data stop with the 19th snapshot after t = 1 s and go on at 1.6 s.
    estimates, _ = fed(SubspaceStage(configuration), blocks[:21] + blocks[26:])
    cut = next(e for e in estimates if e.stamp == EPOCH + SECOND)
    assert cut.covariance_snapshots == 100
    assert cut.covariance_time_offset == pytest.approx((19 - 49.5) / 200.0, abs=1e-12)


@pytest.mark.parametrize("method", ["past", "opast", "block_past", "covariance"])
def test_batch_is_many_single_runs(method: str) -> None:
    data = crossing_data(3, 0.0, 1.0, batch=(3,))
    configuration = replace(PAPER, method=method)
    together = fed(SubspaceStage(configuration), list(blocks_of(data, 50)))[0]
    for run in range(3):
        alone = fed(SubspaceStage(configuration), list(blocks_of(data[run], 50)))[0]
        for batch, single in zip(together, alone, strict=True):
            assert np.abs(batch.basis[run] - single.basis).max() < 1e-10
            assert batch.covariance is not None and single.covariance is not None
            assert np.allclose(batch.covariance[run], single.covariance)
            assert batch.noise_power[run] == pytest.approx(float(single.noise_power))
            assert batch.source_count == -1


def test_a_batch_keeps_an_element_that_is_silent_in_its_runs() -> None:
    """What is left out of one run would be missed in others: all have the same elements."""
    data = crossing_data(3, 0.0, 1.0, batch=(3,)).copy()
    data[..., 4] = 0.0
    estimates, _ = fed(SubspaceStage(PAPER), list(blocks_of(data, 50)))
    assert all(estimate.basis.shape[-2] == data.shape[-1] for estimate in estimates)


def test_sources_are_counted_at_the_start() -> None:
    data = crossing_data(4, 0.0, 1.0)
    estimates, _ = fed(SubspaceStage(SubspaceConfiguration()), list(blocks_of(data)))
    assert all(e.basis.shape[-1] == 5 for e in estimates)
    assert all(e.rank == e.source_count == 5 for e in estimates)
    assert estimates[0].noise_power == pytest.approx(1.0, rel=0.15)
    assert np.all(np.diff(estimates[0].eigenvalues) <= 0.0)


def test_estimates_in_white_noise_bring_the_eigenvectors_of_their_covariance() -> None:
    data = crossing_data(4, 0.0, 1.0)
    white, _ = fed(SubspaceStage(SubspaceConfiguration()), list(blocks_of(data)))
    covariance, vectors = white[-1].covariance, white[-1].eigenvectors
    assert covariance is not None and vectors is not None
    assert np.allclose((vectors * white[-1].eigenvalues) @ vectors.conj().T, covariance)
    noise = 0.5 * np.eye(15, dtype=complex) + 0.5
    told, _ = fed(
        SubspaceStage(SubspaceConfiguration()), list(blocks_of(data, noise_covariance=noise))
    )
    assert told[-1].covariance is not None and told[-1].eigenvectors is None


def test_noise_alone_gives_estimates_without_subspaces() -> None:
    data = circular_noise(np.random.default_rng(5), 600, 15)
    estimates, _ = fed(SubspaceStage(SubspaceConfiguration()), list(blocks_of(data)))
    assert [e.basis.shape for e in estimates] == [(0, 15, 0)] * len(estimates)
    assert len(estimates) >= 2


def test_coloured_noise_leaves_the_span_of_the_sources() -> None:
    index = np.arange(15)
    colour = (0.8 ** np.abs(index[:, None] - index)).astype(complex)
    generator = np.random.default_rng(6)
    steering = steering_vectors(POSITIONS, np.deg2rad([-20.0, 15.0]), WAVENUMBER)
    sources = 3.0 * circular_noise(generator, 800, 2) @ steering.T
    noise = 3.0 * circular_noise(generator, 800, 15) @ np.linalg.cholesky(colour).T
    configuration = SubspaceConfiguration(forgetting_factor=0.995, source_count=2, n_subspaces=1)
    blocks = list(blocks_of(sources + noise, noise_covariance=colour))
    estimate = fed(SubspaceStage(configuration), blocks)[0][-1]
    assert outside(estimate.basis[0], steering) < 0.2
    assert estimate.noise_power == pytest.approx(9.0, rel=0.15)
    # Taking the same noise for white pulls the subspace away.
    white = fed(SubspaceStage(configuration), list(blocks_of(sources + noise)))[0][-1]
    assert outside(white.basis[0], steering) > 1.5 * outside(estimate.basis[0], steering)


def outside(basis: np.ndarray, steering: np.ndarray) -> float:
    """Return the sine of the largest angle of a basis out of the span of steering vectors."""
    first, second = np.linalg.qr(basis).Q, np.linalg.qr(steering).Q
    return float(np.linalg.norm(first - second @ (second.conj().T @ first), 2))


def test_rejected_block_leaves_the_stage_as_it_was() -> None:
    data = crossing_data(7, 0.0, 1.0)
    blocks = list(blocks_of(data))
    stage, untouched = SubspaceStage(PAPER), SubspaceStage(PAPER)
    expected = fed(untouched, blocks)[0]
    bad = replace(blocks[5], data=blocks[5].data * np.nan)
    estimates: list[SubspaceEstimates] = []
    for number, block in enumerate(blocks):
        if number == 5:
            with pytest.raises(InputError):
                stage.update(bad)
        estimates += stage.update(block).estimates
    for first, second in zip(expected, estimates, strict=True):
        assert np.array_equal(first.basis, second.basis)


def test_overlapping_block_is_rejected() -> None:
    blocks = list(blocks_of(crossing_data(8, 0.0, 0.0)))
    stage = SubspaceStage(PAPER)
    fed(stage, blocks[:3])
    with pytest.raises(InputError, match="20 snapshots before the end"):
        stage.update(blocks[2])


def test_gap_keeps_the_recursion_and_says_so() -> None:
    data = crossing_data(9, 0.0, 4.0)
    blocks = list(blocks_of(data))
    # From t = 0.9 s on 1.2 s are lost: the windows of t = 1 and t = 2 s have nothing.
    estimates, notices = fed(SubspaceStage(PAPER), blocks[:19] + blocks[31:])
    assert [notice.culprit for notice in notices] == ["gap"]
    assert "240 snapshots are missing" in notices[0].text
    assert [(e.stamp - EPOCH) // SECOND for e in estimates] == [0, 1, 2, 3, 4]
    assert [len(e.time_offsets) for e in estimates] == [7, 0, 0, 7, 7]
    assert [e.covariance is None for e in estimates] == [False, True, True, False, False]
    assert np.isnan(estimates[1].newest_offset)
    # Well after the gap nothing is left of it.
    whole, _ = fed(SubspaceStage(PAPER), blocks)
    first, second = np.linalg.qr(estimates[-1].basis).Q, np.linalg.qr(whole[-1].basis).Q
    overlap = np.swapaxes(first, -1, -2).conj() @ second
    assert np.linalg.svd(overlap)[1].min() > 1.0 - 1e-9


def test_window_at_the_edge_of_a_gap_is_published_as_far_as_it_came() -> None:
    blocks = list(blocks_of(crossing_data(10, 0.0, 2.0)))
    # The data stop with the last snapshot before t = 1 s and go on at 1.1 s.
    estimates, _ = fed(SubspaceStage(PAPER), blocks[:20] + blocks[22:])
    partial = next(e for e in estimates if e.stamp == EPOCH + SECOND)
    assert partial.time_offsets == pytest.approx(np.array([-3, -2, -1]) / 200.0, abs=1e-12)


def test_long_gap_is_skipped() -> None:
    blocks = list(blocks_of(crossing_data(11, 0.0, 2.0)))
    later = [replace(block, stamp=block.stamp + 10_000 * SECOND) for block in blocks]
    estimates, notices = fed(SubspaceStage(PAPER), blocks + later)
    # The first after the gap has the half of its window that lies in the new data.
    stamps = [(e.stamp - EPOCH) // SECOND for e in estimates]
    assert stamps == [0, 1, 2, 9_999, 10_000, 10_001, 10_002]
    assert [len(e.time_offsets) for e in estimates] == [7, 7, 7, 4, 7, 7, 7]
    assert len(notices) == 1


@pytest.mark.slow
def test_silence_holds_the_recursion() -> None:
    # Forgetting during silence would make the recursion singular after some 5000 snapshots.
    data = crossing_data(12, 0.0, 1.0)
    silence = np.zeros((8000, 15), dtype=complex)
    for method in SUBSPACE_METHODS.names:
        stage = SubspaceStage(replace(PAPER, method=method))
        blocks = list(blocks_of(np.concatenate([data, silence, data])))
        estimates, notices = fed(stage, blocks)
        assert {notice.culprit for notice in notices} == {f"element {n}" for n in range(15)}
        assert all(np.isfinite(e.basis).all() for e in estimates)
        assert [len(e.time_offsets) for e in estimates] == [7] * len(estimates)


def test_end_of_data_flushes_the_open_window() -> None:
    data = crossing_data(13, 0.0, 1.0)[:-4]
    estimates, _ = fed(SubspaceStage(PAPER), list(blocks_of(data, end=True)))
    assert [(e.stamp - EPOCH) // SECOND for e in estimates] == [0, 1]
    assert len(estimates[-1].time_offsets) == 3
    assert [e.next_stamp for e in estimates] == [EPOCH + SECOND, END_OF_DATA]


def test_end_of_data_is_always_told() -> None:
    data = crossing_data(14, 0.0, 1.0)[:300]
    estimates, _ = fed(SubspaceStage(PAPER), list(blocks_of(data, end=True)))
    assert [len(e.time_offsets) for e in estimates] == [7, 0]
    assert estimates[-1].next_stamp == END_OF_DATA


def test_reset_starts_a_new_run() -> None:
    blocks = list(blocks_of(crossing_data(15, 0.0, 1.0)))
    stage = SubspaceStage(PAPER)
    first = fed(stage, blocks)[0]
    stage.reset()
    again = fed(stage, blocks)[0]
    for one, two in zip(first, again, strict=True):
        assert np.array_equal(one.basis, two.basis)


def test_parameters_that_do_not_fit_together() -> None:
    with pytest.raises(ConfigurationError, match="must be odd"):
        SubspaceStage(SubspaceConfiguration(n_subspaces=4))
    with pytest.raises(ConfigurationError, match="covariance_snapshots above zero"):
        SubspaceStage(SubspaceConfiguration(covariance_snapshots=0))
    batch = block_of(crossing_data(16, 0.0, 0.0, batch=(2,)), EPOCH)
    with pytest.raises(InputError, match="batch of runs"):
        SubspaceStage(SubspaceConfiguration()).update(batch)


@pytest.mark.parametrize(("missing", "reported"), [(9.9, True), (10.1, False)])
def test_sample_times_in_a_gap_of_more_than_ten_periods_are_left_out(
    missing: float, reported: bool
) -> None:
    """The period is 1 s; the blocks before the gap and after it last for 3 s and 0.1 s."""
    blocks = list(blocks_of(crossing_data(19, 0.0, 2.0)))
    jump = blocks[-1].stamp + SECOND // 10 + round(missing * SECOND) - blocks[0].stamp
    later = [replace(each, stamp=each.stamp + jump) for each in blocks]
    estimates, _ = fed(SubspaceStage(PAPER), blocks + later)
    lost = [e for e in estimates if len(e.time_offsets) == 0]
    assert (len(lost) > 5) == reported


def test_more_sources_than_the_array_can_tell_apart_are_said() -> None:
    generator = np.random.default_rng(20)
    data = circular_noise(generator, 400, 4) @ np.diag([30.0, 20.0, 10.0, 1.0])
    header: dict[str, Any] = {"element_positions": POSITIONS[:4]}
    blocks = list(blocks_of(data, **header))
    _, notices = fed(SubspaceStage(SubspaceConfiguration()), blocks)
    crowded = [notice for notice in notices if notice.culprit == "rank"]
    assert crowded and "3 sources or more, as many as 4 elements" in crowded[0].text
    _, notices = fed(
        SubspaceStage(SubspaceConfiguration()), list(blocks_of(crossing_data(21, 0.0, 1.0)))
    )
    assert not notices
