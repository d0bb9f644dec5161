"""Kernels of the passive array: subspaces, source numbers, directions."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from sonar_tracking.evaluation.bench.bench_data import (
    PERIOD_SNAPSHOTS,
    SIZES,
    SOURCES,
    WAVENUMBER,
    bench_angles,
    bench_covariance,
    bench_estimates,
    bench_positions,
    bench_snapshots,
    snapshots_at,
    uneven_positions,
)
from sonar_tracking.evaluation.bench.bench_peers import (
    eigenvectors_each_period,
    naive_music,
    textbook_past,
)
from sonar_tracking.evaluation.bench.kernel import Kernel, Prepared, Timed, Work
from sonar_tracking.evaluation.bench.pyroomacoustics_peer import (
    PyroomMusic,
    pyroomacoustics_installed,
)
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.joint_map_filters import JointMapFilters
from sonar_tracking.passive.directions.projection_fit import ProjectionProblem, projection_fit
from sonar_tracking.passive.directions.signal_subspace import signal_subspace
from sonar_tracking.passive.sources.angle_grid import angle_grid
from sonar_tracking.passive.sources.mdl import smoothed_size, source_count
from sonar_tracking.passive.sources.music import music_bearings
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_method import SubspaceMethod
from sonar_tracking.passive.subspaces.subspace_method_registry import SUBSPACE_METHODS
from sonar_tracking.records.arrays import ComplexArray, FloatArray

FORGETTING_FACTOR = 0.97
BLOCK = 20
"""Snapshots of a step of block PAST."""

LARGEST_FOR_PYROOMACOUSTICS = 256
"""Elements: with 512 it takes seconds and gigabytes."""

_COMPLEX = 16.0
"""Bytes of a complex number."""

_MULTIPLY_ADD = 8.0
"""Real operations of a complex one."""


def array_kernels() -> tuple[Kernel, ...]:
    """Return the kernels, over the number of elements."""
    period = f"{PERIOD_SNAPSHOTS} snapshots"
    named: tuple[tuple[str, Callable[[int], Prepared]], ...] = (
        (f"PAST, {SOURCES} columns, a snapshot", _past),
        (f"OPAST, {SOURCES} columns, a snapshot", partial(_recursion, "opast", 4)),
        (f"block PAST, {SOURCES} columns, {BLOCK} snapshots a step, a snapshot", _block_past),
        (f"exponential covariance, {period}", _covariance),
        (f"subspace of a covariance, {SOURCES} columns", _subspace),
        (f"number of sources (MDL), {period}", _number),
        (f"MUSIC, {SOURCES} sources", _music),
        (f"projection fit, {SOURCES} bearings", _projection),
        (f"joint MAP update, {SOURCES} bearings", _joint_map),
    )
    uneven = f"MUSIC, {SOURCES} sources, elements not evenly spaced"
    return (
        *(Kernel(name, "elements", SIZES, prepare) for name, prepare in named),
        Kernel(uneven, "elements", SIZES[:-1], partial(_music, place=uneven_positions)),
    )


def subspace_method(name: str, step: int) -> SubspaceMethod[Any]:
    """Return a method that follows the subspace, by its name and the snapshots of a step."""
    configuration = SubspaceConfiguration(
        method=name, forgetting_factor=FORGETTING_FACTOR, update_snapshots=step
    )
    method: SubspaceMethod[Any] = SUBSPACE_METHODS[name].make(configuration)
    return method


def run_method(
    method: SubspaceMethod[Any], step: int, data: ComplexArray, n_columns: int
) -> ComplexArray:
    """Feed all snapshots to a method and return its basis.

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
    for first in range(0, len(data), step):
        state = method.update(state, data[first : first + step])
    return method.basis(state)


def _past(n_elements: int) -> Prepared:
    data = bench_snapshots(n_elements, SOURCES)
    textbook = Timed(partial(textbook_past, data, SOURCES, FORGETTING_FACTOR), len(data))
    ours = _recursion("past", 3, n_elements)
    return Prepared(ours.ours, ours.work, {"textbook PAST": textbook})


def _recursion(name: str, products: int, n_elements: int) -> Prepared:
    """Return a recursion that multiplies its basis with a vector so many times a snapshot."""
    data = bench_snapshots(n_elements, SOURCES)
    entries = n_elements * SOURCES
    work = Work(
        _MULTIPLY_ADD * (products * entries + 3 * SOURCES**2),
        _COMPLEX * ((products + 1) * entries + n_elements),
    )
    method = subspace_method(name, 1)
    return Prepared(
        Timed(partial(run_method, method, PERIOD_SNAPSHOTS, data, SOURCES), len(data)), work
    )


def _block_past(n_elements: int) -> Prepared:
    data = bench_snapshots(n_elements, SOURCES)
    entries = n_elements * SOURCES
    work = Work(
        _MULTIPLY_ADD * (2 * entries + 2 * entries * SOURCES / BLOCK),
        _COMPLEX * (n_elements + 4 * entries / BLOCK),
    )
    method = subspace_method("block_past", BLOCK)
    return Prepared(Timed(partial(run_method, method, BLOCK, data, SOURCES), len(data)), work)


def _covariance(n_elements: int) -> Prepared:
    data = bench_snapshots(n_elements, SOURCES)
    method = subspace_method("covariance", PERIOD_SNAPSHOTS)
    state = method.start(n_elements, SOURCES)
    half = 0.5 * n_elements * (n_elements + 1)
    work = Work(
        _MULTIPLY_ADD * half * len(data), _COMPLEX * (len(data) * n_elements + 2 * n_elements**2)
    )
    return Prepared(Timed(lambda: method.update(state, data)), work)


def _subspace(n_elements: int) -> Prepared:
    covariance = bench_covariance(n_elements, SOURCES)
    data = bench_snapshots(n_elements, SOURCES)
    peer = Timed(partial(eigenvectors_each_period, data, SOURCES, len(data)))
    return Prepared(
        Timed(partial(signal_subspace, covariance, SOURCES)),
        _one_product(n_elements),
        {"covariance and eigh": peer},
    )


def _one_product(n_elements: int) -> Work:
    """Return the least work of what finds a subspace: one product of the covariance with it."""
    return Work(_MULTIPLY_ADD * n_elements**2 * SOURCES, _COMPLEX * n_elements**2)


def _number(n_elements: int) -> Prepared:
    covariance = bench_covariance(n_elements, SOURCES)
    size = smoothed_size(n_elements, PERIOD_SNAPSHOTS)
    tridiagonal = _MULTIPLY_ADD * 2.0 / 3.0 * size**3
    work = Work(tridiagonal, _COMPLEX * (n_elements**2 + size**2))
    return Prepared(Timed(partial(source_count, covariance, PERIOD_SNAPSHOTS)), work)


def _music(n_elements: int, place: Callable[[int], FloatArray] = bench_positions) -> Prepared:
    positions = place(n_elements)
    snapshots = snapshots_at(positions, SOURCES, PERIOD_SNAPSHOTS)
    covariance = np.asarray(snapshots.T @ snapshots.conj() / len(snapshots))
    angles = angle_grid(positions, WAVENUMBER).angles
    peers = {"naive numpy": Timed(partial(naive_music, covariance, SOURCES, positions, WAVENUMBER))}
    if pyroomacoustics_installed() and n_elements <= LARGEST_FOR_PYROOMACOUSTICS:
        music = PyroomMusic(positions, WAVENUMBER, SOURCES, angles)
        peers["pyroomacoustics"] = Timed(partial(music.bearings, snapshots))
    found = _one_product(n_elements)
    transforms = 5.0 * len(angles) * np.log2(len(angles))
    work = Work(found.flops + transforms, found.bytes + 8.0 * len(angles))
    ours = Timed(partial(music_bearings, covariance, SOURCES, positions, WAVENUMBER))
    return Prepared(ours, work, peers)


def _projection(n_elements: int) -> Prepared:
    subspace = signal_subspace(bench_covariance(n_elements, SOURCES), SOURCES)
    positions = bench_positions(n_elements)
    problem = ProjectionProblem(subspace.steering_combinations(), positions, WAVENUMBER)
    start = bench_angles(SOURCES) + 0.1 / n_elements
    # A step: two products of n_elements x SOURCES x SOURCES for the matrix, two for the error.
    entries = n_elements * SOURCES
    steps = 3
    work = Work(_MULTIPLY_ADD * steps * 4 * entries * SOURCES, _COMPLEX * steps * 4 * entries)
    return Prepared(Timed(partial(projection_fit, problem, start)), work)


def _joint_map(n_elements: int) -> Prepared:
    (estimate,) = bench_estimates(bench_snapshots(n_elements, SOURCES, 300), SOURCES)[:1]
    filters = JointMapFilters(BearingTrackerConfiguration(method="joint_map"))
    mean = np.stack([bench_angles(SOURCES), np.zeros(SOURCES)], axis=-1)
    variance = np.diag([(0.3 / n_elements) ** 2, 1e-6])
    targets = KalmanState(mean, np.broadcast_to(variance, (SOURCES, 2, 2)).copy())
    state = filters.predict(filters.start(targets), 1.0)
    found = _one_product(n_elements)
    entries = n_elements * SOURCES
    fits = 2
    work = Work(found.flops + _MULTIPLY_ADD * fits * 4 * entries * SOURCES, found.bytes)
    return Prepared(Timed(lambda: filters.update(state, estimate, None)), work)
