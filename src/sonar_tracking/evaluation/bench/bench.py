"""The parts of the bench that need no graph: what is measured, one step after the other.

Everything is processor time of one thread, in this process, in one run: figures of different
machines, or of a busy and an idle one, are not the same figures.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from sonar_tracking.evaluation.bench.array_kernels import array_kernels
from sonar_tracking.evaluation.bench.array_stages import (
    ARRAY_CASES,
    ARRAY_LAYOUTS,
    array_exponents,
    measure_array,
    measure_trackers,
)
from sonar_tracking.evaluation.bench.bench_report import BenchPart
from sonar_tracking.evaluation.bench.capacity import CAPACITY_LAYOUTS, capacity
from sonar_tracking.evaluation.bench.contact_stages import (
    CONTACT_LAYOUTS,
    PEER_SCENES,
    SYSTEMS,
    measure_clutter,
    measure_side_by_side,
    stone_soup_installed,
)
from sonar_tracking.evaluation.bench.kernel import KERNEL_LAYOUT, measure_kernel
from sonar_tracking.evaluation.bench.machine import Machine
from sonar_tracking.evaluation.bench.pyroomacoustics_peer import pyroomacoustics_installed
from sonar_tracking.evaluation.bench.tma_stages import (
    CROSS_FIX,
    TARGETS,
    TMA_LAYOUTS,
    measure_scene,
    measure_targets,
    target_exponent,
)
from sonar_tracking.evaluation.bench.tracking_kernels import tracking_kernels
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import TableLayout

TRACKER_SIZES = (15, 64, 256)

NO_STONE_SOUP = "Stone Soup is not installed: its rows are left out (pip install stonesoup)."
NO_PYROOM = "pyroomacoustics is not installed: its rows are left out (pip install pyroomacoustics)."


@dataclass(frozen=True)
class Step:
    """A measurement.

    Attributes
    ----------
    label : str
        What is shown while it goes on.
    measure : callable
        Returns its rows.
    """

    label: str
    measure: Callable[[], tuple[StudyRow, ...]]


@dataclass(frozen=True)
class PartDefinition:
    """A part of the bench.

    Attributes
    ----------
    name : str
        As typed on the command line.
    steps : callable
        ``steps(machine)`` returns what is measured, in order.
    layouts : tuple of TableLayout
        Its tables.
    finished : callable
        ``finished(rows)`` returns the rows with what follows from all of them.
    missing : callable
        Returns a sentence for each peer that is not there.
    """

    name: str
    steps: Callable[[Machine], Sequence[Step]]
    layouts: tuple[TableLayout, ...]
    finished: Callable[[Sequence[StudyRow]], tuple[StudyRow, ...]] = tuple
    missing: Callable[[], tuple[str, ...]] = tuple


def measure_part(
    definition: PartDefinition, machine: Machine, begun: Callable[[str, int, int], None]
) -> BenchPart:
    """Measure a part.

    Parameters
    ----------
    definition : PartDefinition
        Which one.
    machine : Machine
        Its limits.
    begun : callable
        Told label, number and count of each step before it, for a progress display.
    """
    started = time.monotonic()
    steps = definition.steps(machine)
    rows: list[StudyRow] = []
    for number, step in enumerate(steps):
        begun(step.label, number, len(steps))
        rows += step.measure()
    return BenchPart(
        definition.name,
        definition.finished(rows),
        definition.missing(),
        time.monotonic() - started,
        os.getloadavg()[0],
    )


def kernel_steps(machine: Machine) -> tuple[Step, ...]:
    """Return a step for each kernel."""
    kernels = (*array_kernels(), *tracking_kernels())
    return tuple(Step(each.name, partial(measure_kernel, each, machine)) for each in kernels)


def stage_steps(_: Machine) -> tuple[Step, ...]:
    """Return the steps of the stages: arrays, contacts, positions."""
    return (
        *(
            Step(
                f"array of {each.n_elements}: {each.chain}, {each.n_sources} sources",
                _row(measure_array, each),
            )
            for each in ARRAY_CASES
        ),
        *(
            Step(f"bearing trackers, {n_elements} elements", partial(measure_trackers, n_elements))
            for n_elements in TRACKER_SIZES
        ),
        *(Step(f"contacts, {system}", partial(measure_clutter, system)) for system in SYSTEMS),
        *(Step(each.condition, partial(measure_side_by_side, each)) for each in PEER_SCENES),
        *(Step(f"positions of {count} targets", _row(measure_targets, count)) for count in TARGETS),
        Step("one target", measure_scene),
    )


def finished_stages(rows: Sequence[StudyRow]) -> tuple[StudyRow, ...]:
    """Return the rows with exponents, and with what the machine can track."""
    arrays = array_exponents([row for row in rows if "times_real_time" in row.metrics])
    targets = target_exponent([row for row in rows if row.condition == CROSS_FIX])
    with_exponent = {(row.condition, row.system): row for row in (*arrays, *targets)}
    done = tuple(with_exponent.get((row.condition, row.system), row) for row in rows)
    return (*done, *capacity(done))


def kernel_peers_missing() -> tuple[str, ...]:
    """Return a sentence for each peer of the kernels that is not installed."""
    return () if pyroomacoustics_installed() else (NO_PYROOM,)


def stage_peers_missing() -> tuple[str, ...]:
    """Return a sentence for each peer of the stages that is not installed."""
    return () if stone_soup_installed() else (NO_STONE_SOUP,)


def _row(measure: Callable[..., StudyRow], argument: object) -> Callable[[], tuple[StudyRow, ...]]:
    return lambda: (measure(argument),)


KERNELS = PartDefinition("kernels", kernel_steps, (KERNEL_LAYOUT,), missing=kernel_peers_missing)
STAGES = PartDefinition(
    "stages",
    stage_steps,
    (*ARRAY_LAYOUTS, *CONTACT_LAYOUTS, *TMA_LAYOUTS, *CAPACITY_LAYOUTS),
    finished_stages,
    stage_peers_missing,
)
