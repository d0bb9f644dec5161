"""Monte Carlo runs in fixed batches over worker processes, the same numbers whatever their count.

Runs are cut into batches of a fixed size and every run gets one child of the study's seed
sequence, so neither the batch a run is in nor its random numbers depend on how many workers there
are. The work is always done in worker processes with one BLAS thread each, even with one worker:
the caller's process may use several threads, which may sum in another order.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.one_thread import ONE_THREAD
from sonar_tracking.stop_signals import end_at_once

RUNS_PER_BATCH = 20
"""Runs that are computed together; fixed, since the last digits of a run may depend on it."""


@dataclass(frozen=True)
class RunBatch:
    """Runs of a study that are computed together.

    Attributes
    ----------
    first_run : int
        Number of the first run in the study.
    seeds : tuple of numpy.random.SeedSequence
        One a run.
    """

    first_run: int
    seeds: tuple[np.random.SeedSequence, ...]


@dataclass(frozen=True)
class Task:
    """One call that a worker makes.

    Attributes
    ----------
    function : callable
        A function of a module: workers import it by name.
    argument : object
        Its only argument; it is pickled.
    """

    function: Callable[[Any], Any]
    argument: Any


@dataclass(frozen=True)
class Workers:
    """Where batches are computed.

    Attributes
    ----------
    count : int
        Local worker processes; not used with a scheduler.
    scheduler : str
        Address of a running dask scheduler, e.g. ``"tcp://10.0.0.5:8786"``; empty = local.
    """

    count: int = 1
    scheduler: str = ""


def run_batches(
    runs: int, seed: int, part: int = 0, size: int = RUNS_PER_BATCH
) -> tuple[RunBatch, ...]:
    """Cut ``runs`` into fixed batches with one seed sequence a run.

    Parameters
    ----------
    runs : int
        Number of runs, at least 1.
    seed : int
        Root of all randomness, at least 0.
    part : int
        Number of the part of the study; parts draw independent numbers.
    size : int
        Runs a batch; fixed in each study.

    Raises
    ------
    ConfigurationError
        If either is out of range.
    """
    if runs < 1:
        raise ConfigurationError(f"runs is {runs}; a study needs at least 1 run.")
    if seed < 0:
        raise ConfigurationError(f"seed is {seed}; give a whole number of at least 0.")
    seeds = np.random.SeedSequence((seed, part)).spawn(runs)
    return tuple(
        RunBatch(first, tuple(seeds[first : first + size])) for first in range(0, runs, size)
    )


def compute(tasks: Sequence[Task], workers: Workers, done: Callable[[], None]) -> list[Any]:
    """Return what the tasks return, in their order, computed by the workers.

    Parameters
    ----------
    tasks : sequence of Task
        What to compute.
    workers : Workers
        Where to compute.
    done : callable
        Called after every finished task, for a progress display.

    Raises
    ------
    ConfigurationError
        If there are no workers, dask is not installed, or the scheduler does not answer.
    """
    if workers.scheduler:
        return _compute_distributed(tasks, workers.scheduler, done)
    if workers.count < 1:
        raise ConfigurationError(f"workers is {workers.count}; a study needs at least 1.")
    return _compute_locally(tasks, workers.count, done)


def _compute_locally(tasks: Sequence[Task], count: int, done: Callable[[], None]) -> list[Any]:
    try:
        import dask
        from dask.callbacks import Callback
    except ImportError as error:
        raise ConfigurationError("dask is not installed; try: pip install dask.") from error

    def after_task(*_: Any) -> None:
        done()

    # Without names dask takes them up in any order, and a long one at the end leaves workers idle;
    # with these in theirs: of tasks alike it begins with the last name.
    names = (f"task {len(tasks) - number:06d}" for number in range(len(tasks)))
    delayed = [
        dask.delayed(task.function)(task.argument, dask_key_name=name)
        for task, name in zip(tasks, names, strict=True)
    ]
    workers = dask.config.set({"multiprocessing.initializer": end_at_once})
    with workers, _one_thread_in_children(), Callback(posttask=after_task):
        return list(dask.compute(*delayed, scheduler="processes", num_workers=count, chunksize=1))


def _compute_distributed(
    tasks: Sequence[Task], address: str, done: Callable[[], None]
) -> list[Any]:
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise ConfigurationError(
            "A scheduler address needs dask.distributed; try: pip install distributed."
        ) from error
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise ConfigurationError(
            f"The dask scheduler at {address} does not answer; "
            "start it with `dask scheduler` and workers with `dask worker ADDRESS --nthreads 1`."
        ) from error
    with client:
        futures = [client.submit(task.function, task.argument, pure=False) for task in tasks]
        for _ in as_completed(futures):
            done()
        return list(client.gather(futures))


@contextmanager
def _one_thread_in_children() -> Iterator[None]:
    """Let processes started inside inherit an environment that asks for one BLAS thread."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
