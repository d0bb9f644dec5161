"""Runs of the doa-coherent study: every tracker on the same blocks, and the bound of each run.

RYU takes the ordinary eigenvectors of the block covariance, as many as there are targets. PROPOSED
and the joint filter take the generalised eigenvectors, as many as the rank, which both are given.
Both are told the process noise too; one more joint filter has the default one. All start from the
truth, as in the paper, and are the stages that the nodes run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.bearing_histories import BearingHistories
from sonar_tracking.evaluation.monte_carlo.compared_methods import compared_methods
from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.evaluation.monte_carlo.tracking_bound import tracking_bound
from sonar_tracking.evaluation.studies.doa_coherent.scenes import (
    BURST_SNAPSHOTS,
    PERIOD,
    Condition,
    Sources,
    bursts,
    scored_bearings,
    sources_of,
)
from sonar_tracking.evaluation.studies.doa_fusion.runs import histories_of
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.passive.bearings.bearing_method_registry import BEARING_METHODS
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.directions.signal_subspace import signal_subspace
from sonar_tracking.passive.performance.fisher_information import stochastic_fisher_information
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates

PROCESS_NOISE_DEG2 = 1e-6
MEASUREMENT_VARIANCE_DEG2 = 0.05
INITIAL_ANGLE_VARIANCE_DEG2 = 1.0
INITIAL_RATE_VARIANCE_DEG2 = 0.01

RYU = "RYU"
PROPOSED = "PROPOSED"
JOINT = "joint MAP"
DEFAULT = "joint MAP, default q"

METHODS = compared_methods(
    [entry for entry in BEARING_METHODS if entry.needs_covariance],
    {RYU: "ryu", PROPOSED: "coherent", JOINT: "joint_map", DEFAULT: "joint_map"},
)
"""Method of each tracker, by its name: RYU and all that measure in the block covariance."""


@dataclass(frozen=True)
class ConditionBatch:
    """Runs that are computed together.

    Attributes
    ----------
    condition : Condition
        The condition.
    batch : RunBatch
        Which runs.
    """

    condition: Condition
    batch: RunBatch


@dataclass(frozen=True)
class ConditionRuns:
    """What the trackers did in the runs of a batch.

    Attributes
    ----------
    condition : Condition
        The condition.
    histories : mapping of str to BearingHistories
        By name of the tracker, shape (n_runs, n_steps, n_targets).
    bound_deg2 : ndarray, shape (n_runs,)
        Tracking bound, mean over steps and targets, deg^2.
    """

    condition: Condition
    histories: Mapping[str, BearingHistories]
    bound_deg2: FloatArray


def condition_batch(task: ConditionBatch) -> ConditionRuns:
    """Run all trackers on the runs of a batch under one condition.

    Parameters
    ----------
    task : ConditionBatch
        Which runs, under which condition.
    """
    condition = task.condition
    sources = sources_of(condition, task.batch.seeds)
    bound = bound_deg2(sources)
    trackers = {name: BearingTrackerStage(_tracker(name, condition)) for name in METHODS}
    tracks: dict[str, list[BearingTracks]] = {name: [] for name in trackers}
    for estimates in _blocks(sources):
        for name, tracker in trackers.items():
            given = _with_ordinary_basis(estimates) if name == RYU else estimates
            tracks[name].append(tracker.update(given).tracks)
    angles, rates = scored_bearings(condition)
    histories = {name: histories_of(own[1:], angles, rates) for name, own in tracks.items()}
    return ConditionRuns(condition, histories, bound)


def bound_deg2(sources: Sources) -> FloatArray:
    """Return the tracking bound of each run, shape (n_runs,), deg^2.

    Parameters
    ----------
    sources : Sources
        The phases of coherent sources matter.
    """
    condition = sources.condition
    array = condition.scenario().array
    angles, _ = scored_bearings(condition)
    square_degree = np.radians(1.0) ** 2
    initial = np.diag([INITIAL_ANGLE_VARIANCE_DEG2, INITIAL_RATE_VARIANCE_DEG2])
    known: dict[bytes, float] = {}
    bounds = []
    for covariance in sources.covariances():
        key = covariance.tobytes()
        if key not in known:
            information = stochastic_fisher_information(
                array.element_positions(),
                angles,
                array.wavenumber(),
                covariance,
                1.0,
                BURST_SNAPSHOTS,
                condition.noise_covariance(),
            )
            variances = tracking_bound(
                information,
                transition_matrix(PERIOD),
                process_noise_matrix(PROCESS_NOISE_DEG2 * square_degree, PERIOD),
                initial * square_degree,
            )
            known[key] = float(np.mean(variances)) / square_degree
        bounds.append(known[key])
    return np.array(bounds)


def _blocks(sources: Sources) -> Iterator[SubspaceEstimates]:
    """Yield the block covariances of all runs, that of time 0 first."""
    stage = SubspaceStage(
        SubspaceConfiguration(
            method="covariance",
            period=PERIOD,
            source_count=sources.condition.n_targets,
            n_subspaces=1,
            update_snapshots=1,
            covariance_snapshots=BURST_SNAPSHOTS,
            covariance_alignment="centred",
        )
    )
    for block in bursts(sources):
        yield from stage.update(block).estimates


def _with_ordinary_basis(estimates: SubspaceEstimates) -> SubspaceEstimates:
    """Return the estimates with the ordinary eigenvectors of the block, one a target, as basis."""
    assert estimates.covariance is not None
    vectors = signal_subspace(estimates.covariance, estimates.basis.shape[-1]).vectors
    return replace(estimates, basis=vectors[..., None, :, :])


def _tracker(name: str, condition: Condition) -> BearingTrackerConfiguration:
    angles, rates = true_bearings(condition.scenario(), np.zeros(1))
    configuration = BearingTrackerConfiguration(
        method=METHODS[name],
        source_rank=condition.rank,
        start="given",
        initial_bearings_deg=tuple(np.degrees(angles[0]).tolist()),
        initial_rates_deg=tuple(np.degrees(rates[0]).tolist()),
        initial_angle_variance_deg2=INITIAL_ANGLE_VARIANCE_DEG2,
        initial_rate_variance_deg2=INITIAL_RATE_VARIANCE_DEG2,
        measurement_variance_deg2=MEASUREMENT_VARIANCE_DEG2,
        fused_variance="independent",
        phase_reference="first_element",
    )
    if name == DEFAULT:
        return configuration
    return replace(configuration, process_noise_deg2=PROCESS_NOISE_DEG2)
