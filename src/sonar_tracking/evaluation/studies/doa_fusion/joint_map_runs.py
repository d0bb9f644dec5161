"""The joint filter on the data of the doa-fusion study: causal and centred blocks.

Causal: the last 200 snapshots up to the sample time, which tell where the targets were half a
block before. Centred: the 199 snapshots around it, half a second late. The process noise is what
the targets really do, or the default, which finds out when they turn. The number of sources and the
first bearings are given, as to the published trackers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.bearing_histories import BearingHistories
from sonar_tracking.evaluation.monte_carlo.run_synthesis import snapshot_blocks, true_bearings
from sonar_tracking.evaluation.studies.doa_fusion.runs import (
    BLOCK_SNAPSHOTS,
    LEVELS_DB,
    STEP_TIMES,
    fusion_scenario,
    histories_of,
)
from sonar_tracking.evaluation.studies.doa_fusion.systems import (
    INITIAL_ANGLE_VARIANCE_DEG2,
    INITIAL_RATE_VARIANCE_DEG2,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.simulation.scenarios.scenario import Scenario

PROCESS_NOISE_DEG2 = 0.01

CAUSAL = "joint MAP, causal"
CENTRED = "joint MAP, centred"
DEFAULT = "joint MAP, default q"

BLOCKS = {CAUSAL: ("causal", 200), CENTRED: ("centred", 199), DEFAULT: ("causal", 200)}
"""Alignment and snapshots of each tracker's blocks, by its name."""


@dataclass(frozen=True)
class JointRuns:
    """Histories of the trackers in the runs of a batch.

    Attributes
    ----------
    histories : mapping of str to BearingHistories
        By name of the tracker, shape (n_levels, n_runs, n_steps, n_targets).
    """

    histories: Mapping[str, BearingHistories]


def joint_batch(batch: RunBatch) -> JointRuns:
    """Run the trackers on the runs of a batch at all levels.

    Parameters
    ----------
    batch : RunBatch
        Which runs.
    """
    # The same data, and as many more as the last centred block needs.
    scenario = replace(fusion_scenario(), duration=float(STEP_TIMES[-1]) + 2.0)
    n_targets = len(scenario.targets)
    estimators = {
        name: SubspaceStage(_estimator(alignment, n_snapshots, n_targets))
        for name, (alignment, n_snapshots) in BLOCKS.items()
    }
    trackers = {name: BearingTrackerStage(_tracker(scenario, name)) for name in BLOCKS}
    tracks: dict[str, list[BearingTracks]] = {name: [] for name in BLOCKS}
    last_stamp = scenario.stamp(float(STEP_TIMES[-1]))
    for block in snapshot_blocks(scenario, batch.seeds, LEVELS_DB, BLOCK_SNAPSHOTS):
        for name, estimator in estimators.items():
            for estimates in estimator.update(block).estimates:
                if scenario.stamp(0.0) <= estimates.stamp <= last_stamp:
                    tracks[name].append(trackers[name].update(estimates).tracks)
    angles, rates = true_bearings(scenario, STEP_TIMES)
    half_block = 0.5 * (BLOCKS[CAUSAL][1] - 1) / scenario.array.snapshot_rate
    ages = {CAUSAL: half_block, CENTRED: 0.0, DEFAULT: half_block}
    return JointRuns(
        {name: histories_of(own[1:], angles, rates, ages[name]) for name, own in tracks.items()}
    )


def _estimator(alignment: str, n_snapshots: int, n_targets: int) -> SubspaceConfiguration:
    return SubspaceConfiguration(
        method="covariance",
        period=1.0,
        source_count=n_targets,
        n_subspaces=1,
        update_snapshots=1,
        covariance_snapshots=n_snapshots,
        covariance_alignment=alignment,
    )


def _tracker(scenario: Scenario, name: str) -> BearingTrackerConfiguration:
    angles, rates = true_bearings(scenario, np.zeros(1))
    configuration = BearingTrackerConfiguration(
        method="joint_map",
        source_rank=len(scenario.targets),
        start="given",
        initial_bearings_deg=tuple(np.degrees(angles[0]).tolist()),
        initial_rates_deg=tuple(np.degrees(rates[0]).tolist()),
        initial_angle_variance_deg2=INITIAL_ANGLE_VARIANCE_DEG2,
        initial_rate_variance_deg2=INITIAL_RATE_VARIANCE_DEG2,
    )
    if name == DEFAULT:
        return configuration
    return replace(
        configuration,
        process_noise_deg2=PROCESS_NOISE_DEG2,
        steady_process_noise_deg2=PROCESS_NOISE_DEG2,
    )
