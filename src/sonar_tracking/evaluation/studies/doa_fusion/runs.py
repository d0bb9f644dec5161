"""Runs of the doa-fusion study: every tracker on the same subspaces of the same data.

Trackers that start from the truth go through all runs and levels of a batch at once. The automatic
start follows every run by itself. All are the stages that the nodes run.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.bearing_histories import (
    BearingHistories,
    normalised_innovation_squared,
)
from sonar_tracking.evaluation.monte_carlo.history_swaps import lasting_swaps
from sonar_tracking.evaluation.monte_carlo.run_synthesis import snapshot_blocks, true_bearings
from sonar_tracking.evaluation.studies.doa_fusion.systems import (
    AUTOMATIC,
    SYSTEMS,
    automatic_start_configuration,
    given_start_configuration,
    subspace_configuration,
)
from sonar_tracking.filtering.assignment import least_cost_pairs
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerStage,
    update_together,
)
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates, TrackStatus
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

LEVELS_DB = (-5, -3, 0)
"""Signal power over noise power per element, dB."""

STEP_TIMES = np.arange(1.0, 41.0)
"""Sample times that are scored, s."""

BLOCK_SNAPSHOTS = 200


def fusion_scenario() -> Scenario:
    """Return the paper's scenario: five targets, eight crossings."""
    return load_scenario("doa_fusion")


def track_batch(batch: RunBatch) -> dict[str, BearingHistories]:
    """Run all trackers on the runs of a batch at all levels.

    Parameters
    ----------
    batch : RunBatch
        Which runs.

    Returns
    -------
    dict of str to BearingHistories
        By name of the tracker, shape (n_levels, n_runs, n_steps, n_targets).
    """
    scenario = fusion_scenario()
    given = {
        system.name: BearingTrackerStage(given_start_configuration(system, scenario))
        for system in SYSTEMS
    }
    shape = (len(LEVELS_DB), len(batch.seeds))
    runs = list(np.ndindex(shape))
    automatic = [BearingTrackerStage(automatic_start_configuration()) for _ in runs]
    given_tracks: dict[str, list[BearingTracks]] = {name: [] for name in given}
    automatic_tracks: list[list[BearingTracks]] = [[] for _ in runs]
    configuration = subspace_configuration(len(scenario.targets))
    for estimates in scored_subspaces(scenario, configuration, batch, LEVELS_DB):
        for name, tracker in given.items():
            given_tracks[name].append(tracker.update(estimates).tracks)
        updates = update_together(automatic, [single_run(estimates, run) for run in runs])
        for own, update in zip(automatic_tracks, updates, strict=True):
            own.append(update.tracks)

    angles, rates = true_bearings(scenario, STEP_TIMES)
    histories = {
        name: histories_of(tracks[1:], angles, rates) for name, tracks in given_tracks.items()
    }
    found = [
        histories_of(matched_to_targets(tracks[1:], angles), angles, rates)
        for tracks in automatic_tracks
    ]
    histories[AUTOMATIC] = BearingHistories(
        angle=np.reshape([one.angle for one in found], (*shape, *angles.shape)),
        nis=np.reshape([one.nis for one in found], (*shape, *angles.shape)),
        nees=np.reshape([one.nees for one in found], (*shape, *angles.shape)),
        swaps=np.reshape([one.swaps for one in found], shape),
    )
    return histories


def scored_subspaces(
    scenario: Scenario,
    configuration: SubspaceConfiguration,
    batch: RunBatch,
    levels_db: Sequence[float],
) -> Iterator[SubspaceEstimates]:
    """Yield the subspaces of all runs at time 0 and at the steps that are scored.

    Parameters
    ----------
    scenario : Scenario
        What is received.
    configuration : SubspaceConfiguration
        Of the subspace estimator.
    batch : RunBatch
        Which runs.
    levels_db : sequence of float
        Signal power over noise power per element, dB.
    """
    stage = SubspaceStage(configuration)
    last_stamp = scenario.stamp(float(STEP_TIMES[-1]))
    for block in snapshot_blocks(scenario, batch.seeds, levels_db, BLOCK_SNAPSHOTS):
        for estimates in stage.update(block).estimates:
            if estimates.stamp <= last_stamp:
                yield estimates


def single_run(estimates: SubspaceEstimates, run: tuple[int, ...]) -> SubspaceEstimates:
    """Return the estimates of one run out of a batch.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Of a batch of runs.
    run : tuple of int
        Index into the leading dimensions.
    """
    assert estimates.covariance is not None
    return replace(
        estimates,
        basis=estimates.basis[run],
        covariance=estimates.covariance[run],
        eigenvalues=estimates.eigenvalues[run],
        noise_power=estimates.noise_power[run],
    )


def histories_of(
    tracks: Sequence[BearingTracks], angles: FloatArray, rates: FloatArray, age: float = 0.0
) -> BearingHistories:
    """Turn track lists whose column n is target n into histories.

    Parameters
    ----------
    tracks : sequence of BearingTracks
        One a step.
    angles, rates : ndarray, shape (n_steps, n_targets)
        True bearings, rad and rad/s.
    age : float
        How long before its stamp the tracker takes a bearing to have been measured, s.
    """
    angle = np.stack([one.arrival_angle for one in tracks], axis=-2)
    rate = np.stack([one.arrival_angle_rate for one in tracks], axis=-2)
    covariance = np.stack([one.covariance for one in tracks], axis=-4)
    nis = normalised_innovation_squared(
        np.stack([one.innovation for one in tracks], axis=-2),
        np.stack([one.measurement_variance for one in tracks], axis=-2),
        covariance[..., 0, 0] - 2 * age * covariance[..., 0, 1] + age**2 * covariance[..., 1, 1],
    )
    error = np.stack([angle - angles, rate - rates], axis=-1)
    nees = normalised_squared(error, covariance)
    return BearingHistories(angle, nis, nees, lasting_swaps(angle, angles))


def matched_to_targets(tracks: Sequence[BearingTracks], angles: FloatArray) -> list[BearingTracks]:
    """Order track lists so that column n is target n; where target n has no track it is NaN.

    An identity belongs to the target it is matched to at its first confirmed step, for good: if it
    later follows another target, that is an error of the tracker.

    Parameters
    ----------
    tracks : sequence of BearingTracks
        One a step, of a single run.
    angles : ndarray, shape (n_steps, n_targets)
        True bearings, rad.
    """
    target_of: dict[int, int] = {}
    ordered = []
    for one, truth in zip(tracks, angles, strict=True):
        confirmed = np.flatnonzero(one.status == TrackStatus.CONFIRMED)
        new = [row for row in confirmed if int(one.id[row]) not in target_of]
        free = [target for target in range(len(truth)) if target not in target_of.values()]
        distance = np.abs(one.arrival_angle[new][:, None] - truth[free])
        for row, column in zip(*least_cost_pairs(distance), strict=True):
            target_of[int(one.id[new[row]])] = free[column]
        rows = np.full(len(truth), -1)
        for row in confirmed:
            if int(one.id[row]) in target_of:
                rows[target_of[int(one.id[row])]] = row
        ordered.append(_columns(one, rows))
    return ordered


def _columns(tracks: BearingTracks, rows: IntArray) -> BearingTracks:
    """Pick rows of a track list; row -1 gives NaN and the covariance of nothing known."""

    def picked(values: FloatArray) -> FloatArray:
        padded = np.concatenate([values, np.full((1, *values.shape[1:]), np.nan)])
        return padded[rows]

    nothing_known = np.full((1, 2, 2), np.nan)
    return replace(
        tracks,
        arrival_angle=picked(tracks.arrival_angle),
        arrival_angle_rate=picked(tracks.arrival_angle_rate),
        covariance=np.concatenate([tracks.covariance, nothing_known])[rows],
        measurement_variance=picked(tracks.measurement_variance),
        innovation=picked(tracks.innovation),
    )
