"""Speed of subspace, bearing and contact tracking, side by side with plain codings and peers.

Everything is measured on one core in one run, since figures from different runs or machines cannot
be compared. A subspace figure is the best of several repetitions over the same data: other work on
the machine can only slow a repetition down.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.evaluation.bench.bench_contacts import (
    CLUTTER,
    CONTACT_LAYOUTS,
    PEER_SCENES,
    measure_clutter,
    measure_side_by_side,
    stone_soup_installed,
)
from sonar_tracking.evaluation.bench.bench_peers import (
    eigenvectors_each_period,
    eigenvectors_each_snapshot,
    textbook_past,
)
from sonar_tracking.evaluation.monte_carlo.batch_runner import Task, Workers, compute
from sonar_tracking.evaluation.monte_carlo.study import Study, StudyRow, write_json
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.evaluation.monte_carlo.study_report import print_study
from sonar_tracking.geometry import line_array
from sonar_tracking.passive.bearings.bearing_method_registry import BEARING_METHODS
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_method import SubspaceMethod
from sonar_tracking.passive.subspaces.subspace_method_registry import SUBSPACE_METHODS
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    synthesize_snapshots,
)

SIZES = ((15, 5), (64, 5), (128, 5), (128, 10))
"""Elements and sources."""

PERIOD_SNAPSHOTS = 200
PERIODS = 8
REPETITIONS = 5
FORGETTING_FACTOR = 0.97
SOUND_SPEED = 1500.0
WAVELENGTH = 0.075
SEED = 1

PEER = "peer: textbook PAST"
SLOW_PEER = "peer: eigh each snapshot"
SLOW_PEER_SNAPSHOTS = 40

PORTIONS = {
    "block_past": (("block_past, L 16", 16), ("block_past, L 64", 64)),
    "covariance": (("covariance, blocks of 20", 20), ("covariance, blocks of 200", 200)),
}
"""Names of the rows and snapshots given at a time, of methods that do not get a whole period."""

TRACKERS = {"ryu, 1 subspace": "ryu", "ml_fusion, 7 subspaces": "ml_fusion"} | {
    name: name for name in BEARING_METHODS.names if name not in ("ryu", "ml_fusion")
}
"""Methods of the tracker by the names of their rows."""

LAYOUTS = (
    TableLayout(
        "Subspace tracking, one core",
        (
            Column("snapshots_per_second", "snapshots/s", ",.0f"),
            Column("microseconds_per_snapshot", "µs each", ".2f"),
            Column("speed_over_textbook", "x textbook", ".2f"),
        ),
        "Peers are plain numpy codings, one snapshot at a time. The others give a basis once a "
        f"period of {PERIOD_SNAPSHOTS} snapshots; eigh each period has no memory beyond it.",
    ),
    TableLayout(
        "Bearing tracking, one core",
        (Column("milliseconds_per_period", "ms/period", ".2f"),),
        "All targets, with variances from the data; subspaces and covariance already there.",
    ),
)


def run_bench(json: Path | None = None) -> Study:
    """Measure, print the tables and write what was asked for.

    Parameters
    ----------
    json : Path, optional
        File for the figures.

    Returns
    -------
    Study
        One row a method and array size, or amount of clutter.
    """
    from rich.console import Console
    from rich.progress import Progress

    console = Console()
    started = time.perf_counter()
    tasks = [
        *(Task(measure_size, size) for size in SIZES),
        *(Task(measure_clutter, clutter) for clutter in CLUTTER),
        *(Task(measure_side_by_side, scene) for scene in PEER_SCENES),
    ]
    with Progress(console=console, transient=True) as progress:
        bar = progress.add_task("bench", total=len(tasks))
        results = compute(tasks, Workers(1), lambda: progress.advance(bar))
    rows = tuple(row for part in results for row in part)
    study = Study("bench", REPETITIONS, SEED, time.perf_counter() - started, rows)
    print_study(study, (*LAYOUTS, *CONTACT_LAYOUTS), console)
    if not stone_soup_installed():
        text = "Stone Soup is not installed: rows of the peer are left out (pip install stonesoup)."
        console.print(text, style="yellow")
    if json is not None:
        write_json((study,), Path(json))
    return study


def measure_size(size: tuple[int, int]) -> tuple[StudyRow, ...]:
    """Measure everything for one array size.

    Parameters
    ----------
    size : tuple of int
        Elements and sources.
    """
    n_elements, n_sources = size
    condition = f"M {n_elements}, N {n_sources}"
    data = bench_snapshots(n_elements, n_sources)
    names, counts, calls = zip(*_subspace_calls(data, n_sources), strict=True)
    seconds = [best / count for best, count in zip(_best_seconds(calls), counts, strict=True)]
    subspaces = [
        StudyRow(
            name,
            condition,
            {
                "snapshots_per_second": 1.0 / each,
                "microseconds_per_snapshot": 1e6 * each,
                "speed_over_textbook": seconds[names.index(PEER)] / each,
            },
        )
        for name, each in zip(names, seconds, strict=True)
    ]
    estimates = bench_estimates(data, n_sources)
    periods = _best_seconds([partial(run_tracker, m, estimates) for m in TRACKERS.values()])
    trackers = [
        StudyRow(name, condition, {"milliseconds_per_period": 1e3 * best / len(estimates)})
        for name, best in zip(TRACKERS, periods, strict=True)
    ]
    return (*subspaces, *trackers)


def bench_angles(n_sources: int) -> FloatArray:
    """Return arrival angles spread evenly in their sine, shape (n_sources,), rad."""
    return np.asarray(np.arcsin(np.linspace(-0.8, 0.8, n_sources)), dtype=np.float64)


def bench_snapshots(n_elements: int, n_sources: int) -> ComplexArray:
    """Return snapshots of separated sources at 0 dB, shape (n_snapshots, n_elements)."""
    generator = np.random.default_rng(SEED)
    n_snapshots = PERIODS * PERIOD_SNAPSHOTS
    return synthesize_snapshots(
        line_array(n_elements, 0.5 * WAVELENGTH),
        2.0 * np.pi / WAVELENGTH,
        np.broadcast_to(bench_angles(n_sources), (n_snapshots, n_sources)),
        circular_gaussian(generator, (n_snapshots, n_sources)),
        circular_gaussian(generator, (n_snapshots, n_elements)),
    )


def bench_estimates(data: ComplexArray, n_sources: int) -> tuple[SubspaceEstimates, ...]:
    """Return the subspaces of every period of the snapshots, seven a period.

    Parameters
    ----------
    data : ndarray, shape (n_snapshots, n_elements), complex
        Snapshots, linear amplitude.
    n_sources : int
        Dimension of the subspaces.
    """
    stage = SubspaceStage(
        SubspaceConfiguration(
            method="covariance",
            period=1.0,
            source_count=n_sources,
            n_subspaces=7,
            covariance_snapshots=PERIOD_SNAPSHOTS,
        )
    )
    block = ArraySnapshots(
        stamp=NANOSECONDS,
        data=data,
        element_positions=line_array(data.shape[1], 0.5 * WAVELENGTH),
        sample_period=1.0 / PERIOD_SNAPSHOTS,
        center_frequency=SOUND_SPEED / WAVELENGTH,
        bandwidth=0.0,
        sound_speed=SOUND_SPEED,
    )
    return stage.update(block).estimates


def run_tracker(method: str, estimates: Sequence[SubspaceEstimates]) -> None:
    """Track the bearings through the subspaces of all periods.

    Parameters
    ----------
    method : str
        Of the tracker.
    estimates : sequence of SubspaceEstimates
        One a period.
    """
    angles = bench_angles(estimates[0].basis.shape[-1])
    tracker = BearingTrackerStage(
        BearingTrackerConfiguration(
            method=method,
            start="given",
            initial_bearings_deg=tuple(np.degrees(angles).tolist()),
            initial_rates_deg=(0.0,) * len(angles),
        )
    )
    for one in estimates:
        tracker.update(one)


def run_method(
    method: SubspaceMethod[Any], step: int, data: ComplexArray, n_columns: int
) -> ComplexArray:
    """Feed all snapshots to a method, take a basis once a period and return the last one.

    Parameters
    ----------
    method : SubspaceMethod
        The method.
    step : int
        Snapshots in a portion.
    data : ndarray, shape (n_snapshots, n_elements), complex
        Snapshots, linear amplitude.
    n_columns : int
        Dimension of the subspace.

    Returns
    -------
    ndarray, shape (n_elements, n_columns), complex
        Pure numbers.
    """
    state = method.start(data.shape[1], n_columns)
    portions_in_period = PERIOD_SNAPSHOTS // step
    for number, first in enumerate(range(0, len(data), step)):
        state = method.update(state, data[first : first + step])
        if number % portions_in_period == portions_in_period - 1:
            basis = method.basis(state)
    return basis


def _subspace_calls(
    data: ComplexArray, n_sources: int
) -> Iterator[tuple[str, int, Callable[[], object]]]:
    beta = FORGETTING_FACTOR
    yield PEER, len(data), partial(textbook_past, data, n_sources, beta)
    few = data[:SLOW_PEER_SNAPSHOTS]
    yield SLOW_PEER, len(few), partial(eigenvectors_each_snapshot, few, n_sources, beta)
    each_period = partial(eigenvectors_each_period, data, n_sources, PERIOD_SNAPSHOTS)
    yield "eigh each period", len(data), each_period
    for entry in SUBSPACE_METHODS:
        for name, step in PORTIONS.get(entry.name, ((entry.name, PERIOD_SNAPSHOTS),)):
            method = entry.make(
                SubspaceConfiguration(
                    method=entry.name, forgetting_factor=beta, update_snapshots=step
                )
            )
            yield name, len(data), partial(run_method, method, step, data, n_sources)


def _best_seconds(calls: Sequence[Callable[[], object]]) -> list[float]:
    """Return the best time of each call, s; they take turns, so that all see the same machine."""
    best = [np.inf] * len(calls)
    for _ in range(REPETITIONS):
        for index, call in enumerate(calls):
            started = time.perf_counter()
            call()
            best[index] = min(best[index], time.perf_counter() - started)
    return best
