"""Consistency of trackers that take their measurement variance from the data.

The paper's R = 36 deg^2 is so pessimistic that no claimed fused variance can do harm. Here R comes
from the Fisher information and the process noise is what the targets really do, on the scenario of
the paper: a filter that believes the mean of seven subspaces to be seven times better than one then
becomes overconfident, and one that accounts for the correlation of adjacent subspaces does not.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.bearing_histories import BearingHistories
from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.evaluation.studies.doa_fusion.runs import (
    LEVELS_DB,
    STEP_TIMES,
    fusion_scenario,
    histories_of,
    scored_subspaces,
)
from sonar_tracking.evaluation.studies.doa_fusion.systems import (
    INITIAL_ANGLE_VARIANCE_DEG2,
    INITIAL_RATE_VARIANCE_DEG2,
    N_SUBSPACES,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.directions.measurement_fusion import mean_age
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.bearings import BearingTracks

FORGETTING_FACTOR = 0.95
PROCESS_NOISE_DEG2 = 0.01

SYSTEMS = {
    "one subspace": ("ryu", "correlated"),
    "7, eq. 14": ("ml_fusion", "independent"),
    "7, correlated": ("ml_fusion", "correlated"),
}
"""Method and fused variance of each tracker, by name."""


@dataclass(frozen=True)
class CalibratedRuns:
    """Histories of the trackers in the runs of a batch.

    Attributes
    ----------
    histories : mapping of str to BearingHistories
        By name of the tracker, shape (n_levels, n_runs, n_steps, n_targets).
    """

    histories: Mapping[str, BearingHistories]


def calibrated_batch(batch: RunBatch) -> CalibratedRuns:
    """Run the trackers on the runs of a batch at all levels.

    Parameters
    ----------
    batch : RunBatch
        Which runs.
    """
    scenario = fusion_scenario()
    start_angles, start_rates = true_bearings(scenario, np.zeros(1))
    trackers = {
        name: BearingTrackerStage(
            BearingTrackerConfiguration(
                method=method,
                start="given",
                initial_bearings_deg=tuple(np.degrees(start_angles[0]).tolist()),
                initial_rates_deg=tuple(np.degrees(start_rates[0]).tolist()),
                initial_angle_variance_deg2=INITIAL_ANGLE_VARIANCE_DEG2,
                initial_rate_variance_deg2=INITIAL_RATE_VARIANCE_DEG2,
                process_noise_deg2=PROCESS_NOISE_DEG2,
                fused_variance=fused_variance,
            )
        )
        for name, (method, fused_variance) in SYSTEMS.items()
    }
    configuration = SubspaceConfiguration(
        method="past",
        forgetting_factor=FORGETTING_FACTOR,
        period=1.0,
        source_count=len(scenario.targets),
        n_subspaces=N_SUBSPACES,
    )
    tracks: dict[str, list[BearingTracks]] = {name: [] for name in trackers}
    for estimates in scored_subspaces(scenario, configuration, batch, LEVELS_DB):
        for name, tracker in trackers.items():
            tracks[name].append(tracker.update(estimates).tracks)
    angles, rates = true_bearings(scenario, STEP_TIMES)
    age = mean_age(FORGETTING_FACTOR) / scenario.array.snapshot_rate
    return CalibratedRuns(
        {name: histories_of(lists[1:], angles, rates, age) for name, lists in tracks.items()}
    )
