"""Protects: a study's numbers are a function of runs and seed, never of the workers."""

import os
import time

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.monte_carlo.batch_runner import (
    RUNS_PER_BATCH,
    RunBatch,
    Task,
    Workers,
    compute,
    run_batches,
)


def draw(batch: RunBatch) -> tuple[float, ...]:
    return tuple(float(np.random.default_rng(seed).standard_normal()) for seed in batch.seeds)


def thread_settings(_: None) -> str | None:
    return os.environ.get("OPENBLAS_NUM_THREADS")


def test_batches_have_fixed_size_and_hold_every_run_once() -> None:
    batches = run_batches(2 * RUNS_PER_BATCH + 3, seed=5)
    assert [len(batch.seeds) for batch in batches] == [RUNS_PER_BATCH, RUNS_PER_BATCH, 3]
    assert [batch.first_run for batch in batches] == [0, RUNS_PER_BATCH, 2 * RUNS_PER_BATCH]


def test_a_run_draws_the_same_numbers_in_a_longer_study() -> None:
    short = draw(run_batches(4, seed=5)[0])
    assert draw(run_batches(30, seed=5)[0])[:4] == short


def test_seeds_and_parts_draw_different_numbers() -> None:
    first = draw(run_batches(3, seed=5)[0])
    assert draw(run_batches(3, seed=6)[0]) != first
    assert draw(run_batches(3, seed=5, part=1)[0]) != first


@pytest.mark.slow
def test_results_keep_the_order_of_the_tasks_and_each_is_reported() -> None:
    tasks = [Task(draw, batch) for batch in run_batches(35, seed=5)]
    done: list[None] = []
    results = compute(tasks, Workers(2), lambda: done.append(None))
    assert results == [draw(task.argument) for task in tasks]
    assert len(done) == len(tasks)


def now(_: None) -> int:
    return time.monotonic_ns()


@pytest.mark.slow
def test_tasks_are_begun_in_their_order() -> None:
    """Long ones first: then no worker waits long for the last of them."""
    begun = compute([Task(now, None)] * 6, Workers(1), lambda: None)
    assert begun == sorted(begun)


@pytest.mark.slow
def test_workers_use_one_thread_and_the_caller_keeps_its_own_setting(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "7")
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    assert compute([Task(thread_settings, None)], Workers(1), lambda: None) == ["1"]
    assert os.environ["OPENBLAS_NUM_THREADS"] == "7"
    assert "OMP_NUM_THREADS" not in os.environ


def test_a_distributed_scheduler_gives_the_same_results() -> None:
    distributed = pytest.importorskip("distributed")
    tasks = [Task(draw, batch) for batch in run_batches(12, seed=5)]
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        results = compute(tasks, Workers(scheduler=cluster.scheduler_address), lambda: None)
    assert results == [draw(task.argument) for task in tasks]


@pytest.mark.parametrize(
    ("runs", "seed", "culprit"), [(0, 1, "runs is 0"), (-3, 1, "runs is -3"), (5, -1, "seed is -1")]
)
def test_impossible_run_counts_and_seeds_are_named(runs: int, seed: int, culprit: str) -> None:
    with pytest.raises(ConfigurationError, match=culprit):
        run_batches(runs, seed)


def test_no_workers_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="workers is 0"):
        compute([Task(thread_settings, None)], Workers(0), lambda: None)


def test_a_scheduler_that_does_not_answer_is_named() -> None:
    pytest.importorskip("distributed")
    with pytest.raises(ConfigurationError, match="not-a-scheme://nowhere"):
        compute([Task(thread_settings, None)], Workers(scheduler="not-a-scheme://nowhere"), print)
