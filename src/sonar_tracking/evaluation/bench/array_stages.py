"""Subspaces and bearing tracks of an array, stage by stage, over elements and targets.

Blocks of snapshots go through the stages as in a graph, but in one process. A block that completes
an estimate costs more than one that does not; the difference is the cost of the estimate.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from sonar_tracking.evaluation.bench.bench_data import (
    PERIOD_SNAPSHOTS,
    SIZES,
    SOURCES,
    bench_angles,
    bench_block,
    bench_estimates,
    bench_snapshots,
)
from sonar_tracking.evaluation.bench.timing import cpu_seconds, scaling_exponent
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.passive.bearings.bearing_method_registry import BEARING_METHODS
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import NANOSECONDS

SNAPSHOT_RATE = 200
BLOCK = 20
SECONDS = 8
DEFAULT = "default: covariance, joint_map"
PUBLISHED = "published: past, ml_fusion of 7 subspaces"

TRACKERS = {"ryu, 1 subspace": "ryu", "ml_fusion, 7 subspaces": "ml_fusion"} | {
    name: name for name in BEARING_METHODS.names if name not in ("ryu", "ml_fusion")
}
"""Methods of the tracker by the names of their rows."""

ARRAY_LAYOUTS = (
    TableLayout(
        "Array to bearings, 200 snapshots/s, one thread",
        (
            Column("microseconds_per_snapshot", "µs/snapshot", ".1f"),
            Column("milliseconds_per_estimate", "ms/estimate", ".2f"),
            Column("milliseconds_per_track_update", "ms/tracks", ".2f"),
            Column("first_milliseconds", "first, ms", ".1f"),
            Column("times_real_time", "x real time", ".1f"),
            Column("exponent", "exponent", ".2f"),
        ),
        "Estimator: each snapshot and each estimate; tracker: each list of tracks; first: both, "
        "for the first estimate. Real time: estimator and tracker on a core each. Exponent: of the "
        "slower of the two over the elements.",
    ),
    TableLayout(
        "Bearing trackers, one thread",
        (Column("milliseconds_per_period", "ms/period", ".2f"),),
        "All targets, with variances from the data; subspaces and covariance already there.",
    ),
)


@dataclass(frozen=True)
class ArrayCase:
    """What is measured.

    Attributes
    ----------
    chain : str
        Name of the parameters.
    n_elements, n_sources : int
        Size of the problem.
    """

    chain: str
    n_elements: int
    n_sources: int


ARRAY_CASES = (
    *(ArrayCase(DEFAULT, size, count) for count in (2, SOURCES, 10) for size in SIZES),
    *(ArrayCase(PUBLISHED, size, SOURCES) for size in SIZES),
)


def measure_array(case: ArrayCase) -> StudyRow:
    """Measure the passive chain at one size.

    Parameters
    ----------
    case : ArrayCase
        Which one.
    """
    estimator, tracker = _stages(case)
    costs = _Costs([], [], [])
    for block in _blocks(case):
        started = time.process_time()
        estimates = estimator.update(block).estimates
        spent = time.process_time() - started
        (costs.with_estimate if estimates else costs.without).append(spent)
        for estimate in estimates:
            started = time.process_time()
            tracker.update(estimate)
            costs.tracker.append(time.process_time() - started)
    condition = f"{case.chain}, {case.n_sources} sources"
    return StudyRow(f"elements {case.n_elements}", condition, costs.figures())


def array_exponents(rows: Sequence[StudyRow]) -> tuple[StudyRow, ...]:
    """Return the rows of all sizes, with the exponent in the largest one of each condition.

    Parameters
    ----------
    rows : sequence of StudyRow
        From :func:`measure_array`.
    """
    done = []
    for row in rows:
        same = [each for each in rows if each.condition == row.condition]
        figures = dict(row.metrics)
        if row is same[-1]:
            sizes = [float(each.system.split()[-1]) for each in same]
            seconds = [1.0 / each.metrics["times_real_time"] for each in same]
            figures["exponent"] = scaling_exponent(sizes, seconds)
        done.append(StudyRow(row.system, row.condition, figures))
    return tuple(done)


def measure_trackers(n_elements: int) -> tuple[StudyRow, ...]:
    """Measure every method of the bearing tracker.

    Parameters
    ----------
    n_elements : int
        Of the array.
    """
    n_periods = 4
    data = bench_snapshots(n_elements, SOURCES, n_periods * PERIOD_SNAPSHOTS)
    estimates = bench_estimates(data, SOURCES)
    rows = []
    for name, method in TRACKERS.items():
        best = cpu_seconds(partial(run_tracker, method, estimates), 0.1)
        figures = {"milliseconds_per_period": 1e3 * best / len(estimates)}
        rows.append(StudyRow(name, f"elements {n_elements}, {SOURCES} sources", figures))
    return tuple(rows)


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


@dataclass(frozen=True)
class _Costs:
    """Processor time of each block, by whether it completed an estimate, and of each update, s."""

    without: list[float]
    with_estimate: list[float]
    tracker: list[float]

    def figures(self) -> dict[str, float]:
        plain = float(np.median(self.without))
        estimate = max(float(np.median(self.with_estimate[1:])) - plain, 0.0)
        update = float(np.median(self.tracker[1:]))
        share = (len(self.with_estimate) + len(self.without)) * plain
        share = (share + len(self.with_estimate) * estimate) / SECONDS
        tracking = len(self.tracker) * update / SECONDS
        return {
            "microseconds_per_snapshot": 1e6 * plain / BLOCK,
            "milliseconds_per_estimate": 1e3 * estimate,
            "milliseconds_per_track_update": 1e3 * update,
            "first_milliseconds": 1e3 * (self.with_estimate[0] + self.tracker[0]),
            "times_real_time": 1.0 / max(share, tracking),
        }


def _stages(case: ArrayCase) -> tuple[SubspaceStage, BearingTrackerStage]:
    if case.chain == DEFAULT:
        return (
            SubspaceStage(SubspaceConfiguration()),
            BearingTrackerStage(BearingTrackerConfiguration()),
        )
    subspaces = SubspaceConfiguration(method="past", n_subspaces=7, forgetting_factor=0.86)
    return (
        SubspaceStage(subspaces),
        BearingTrackerStage(BearingTrackerConfiguration(method="ml_fusion")),
    )


def _blocks(case: ArrayCase) -> Iterator[ArraySnapshots]:
    """Yield the data, made of one period that is rotated: new noise costs more than the stages."""
    period = bench_snapshots(case.n_elements, case.n_sources, 5 * PERIOD_SNAPSHOTS)
    sample_period = 1.0 / SNAPSHOT_RATE
    for first in range(0, SECONDS * SNAPSHOT_RATE, BLOCK):
        begin = first % len(period)
        stamp = NANOSECONDS + round(first * sample_period * NANOSECONDS)
        yield bench_block(period[begin : begin + BLOCK], stamp, sample_period)
