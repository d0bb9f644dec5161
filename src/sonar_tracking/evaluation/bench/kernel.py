"""A piece of numerical work, how it is measured, and how near it is to what the machine can do.

The least work is counted, not what is done: real additions and multiplications (a complex
multiplication with addition is 8), and bytes that have to be read or written when nothing is kept
in a cache. What rearranges its work comes nearer to the limits, or passes them when it needs less.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from sonar_tracking.evaluation.bench.machine import Machine
from sonar_tracking.evaluation.bench.timing import cpu_seconds, scaling_exponent
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout

PATIENCE = 0.15
"""For each call, s."""

PEER = "peer: "

KERNEL_LAYOUT = TableLayout(
    "Kernels, one thread",
    (
        Column("microseconds", "µs", ",.1f"),
        Column("dgemm_percent", "% of dgemm", ".1f"),
        Column("copy_percent", "% of copy", ".1f"),
        Column("peer_over_ours", "x ours", ".2f"),
        Column("exponent", "exponent", ".2f"),
    ),
    "Processor time of the fastest of several batches. The shares are of the least work, not of "
    "what is done; the larger of the two is how near a kernel is to the machine's limit (above 100 "
    "% of copy: the data stay in the cache). x ours: the peer's time. Exponent: over all sizes.",
)


@dataclass(frozen=True)
class Work:
    """The least work of one step.

    Attributes
    ----------
    flops : float
        Real additions and multiplications.
    bytes : float
        Read and written.
    """

    flops: float
    bytes: float


@dataclass(frozen=True)
class Timed:
    """A call, and the steps it makes.

    Attributes
    ----------
    call : callable
        Always with the same data.
    steps : int
        E.g. snapshots; its time is given for one.
    """

    call: Callable[[], object]
    steps: int = 1

    def seconds(self) -> float:
        """Return the processor time of a step, s."""
        return cpu_seconds(self.call, PATIENCE) / self.steps


@dataclass(frozen=True)
class Prepared:
    """A kernel with data of one size.

    Attributes
    ----------
    ours : Timed
        The product.
    work : Work
        Least work of a step.
    peers : mapping of str to Timed
        Others that do the same, by name.
    """

    ours: Timed
    work: Work
    peers: Mapping[str, Timed] = field(default_factory=dict)


@dataclass(frozen=True)
class Kernel:
    """A piece of numerical work at several sizes.

    Attributes
    ----------
    name : str
        What a step does.
    unit : str
        What there are so many of, e.g. ``"elements"``.
    sizes : tuple of int
        How many, ascending.
    prepare : callable
        ``prepare(size)`` returns it with data.
    """

    name: str
    unit: str
    sizes: tuple[int, ...]
    prepare: Callable[[int], Prepared]


def measure_kernel(kernel: Kernel, machine: Machine) -> tuple[StudyRow, ...]:
    """Measure a kernel at all sizes, beside its peers.

    Parameters
    ----------
    kernel : Kernel
        What to measure.
    machine : Machine
        Its limits.
    """
    rows: list[StudyRow] = []
    seconds: dict[str, dict[int, float]] = {"": {}}
    for size in kernel.sizes:
        prepared = kernel.prepare(size)
        ours = prepared.ours.seconds()
        seconds[""][size] = ours
        label = f"{kernel.unit} {size}"
        figures = {"microseconds": 1e6 * ours, **_shares(prepared.work, ours, machine)}
        rows.append(StudyRow(label, kernel.name, figures))
        for name, peer in prepared.peers.items():
            each = peer.seconds()
            seconds.setdefault(name, {})[size] = each
            figures = {"microseconds": 1e6 * each, "peer_over_ours": each / ours}
            rows.append(StudyRow(f"{label}, {PEER}{name}", kernel.name, figures))
    return tuple(_with_exponents(rows, kernel, seconds))


def _shares(work: Work, seconds: float, machine: Machine) -> dict[str, float]:
    return {
        "dgemm_percent": 1e-7 * work.flops / seconds / machine.dgemm_gflops,
        "copy_percent": 1e-7 * work.bytes / seconds / machine.copy_gb_s,
    }


def _with_exponents(
    rows: list[StudyRow], kernel: Kernel, seconds: Mapping[str, Mapping[int, float]]
) -> list[StudyRow]:
    """Return the rows with the exponent in that of the largest size of each system."""
    exponents = {}
    for name, by_size in seconds.items():
        suffix = f", {PEER}{name}" if name else ""
        label = f"{kernel.unit} {max(by_size)}{suffix}"
        exponents[label] = scaling_exponent([*by_size], [*by_size.values()])
    return [
        StudyRow(row.system, row.condition, {**row.metrics, "exponent": exponents[row.system]})
        if math.isfinite(exponents.get(row.system, math.nan))
        else row
        for row in rows
    ]
