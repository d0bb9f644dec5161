"""The published comparison on a reduced number of runs: what the gain is and where it comes from.

Bounds are wider than the spread between seeds of 30 runs; the full study is an evaluation.
"""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from tests.passive.crossing_scene import (
    EPOCH,
    block_of,
    crossing_angles,
    crossing_rates,
    snapshots_of,
)

RUNS = 30


def published(method: str, variance: float) -> BearingTrackerStage:
    """Return a tracker with the settings of the paper, started from truth."""
    return BearingTrackerStage(
        BearingTrackerConfiguration(
            method=method,
            start="given",
            initial_bearings_deg=tuple(np.rad2deg(crossing_angles(0.0))),
            initial_rates_deg=tuple(np.rad2deg(crossing_rates(0.0))),
            process_noise_deg2=1.0,
            measurement_variance_deg2=variance,
            fused_variance="independent",
            phase_reference="first_element",
        )
    )


def scores(level_db: float, trackers: dict[str, BearingTrackerStage]) -> dict[str, tuple]:
    """Return mean squared error (deg^2) over successful runs and success rate of each tracker."""
    generator = np.random.default_rng(1)
    stage = SubspaceStage(
        SubspaceConfiguration(
            method="past",
            forgetting_factor=0.86,
            period=1.0,
            source_count=5,
            n_subspaces=7,
            covariance_snapshots=0,
        )
    )
    angles: dict[str, list] = {name: [] for name in trackers}
    for first in range(-200, 8200, 200):
        times = np.arange(first, first + 200) / 200.0
        data = snapshots_of(generator, crossing_angles(times), level_db, (RUNS,))
        block = block_of(data, EPOCH + first * 5_000_000)
        for estimates in stage.update(block).estimates:
            for name, tracker in trackers.items():
                angles[name].append(tracker.update(estimates).tracks.arrival_angle)
    truth = crossing_angles(np.arange(1.0, 41.0))
    result = {}
    for name, values in angles.items():
        errors = np.rad2deg(np.array(values)[1:41] - truth[:, None])
        success = (np.abs(errors[-5:]) < 3.0).all(axis=(0, 2))
        result[name] = (float(np.mean(errors[:, success] ** 2)), float(success.mean()))
    return result


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level_db", "ratio", "single", "fused"), [(-5.0, 0.5, 1.25, 0.48), (0.0, 0.65, 0.40, 0.19)]
)
def test_fusion_gains_what_was_published_and_mostly_by_its_gain(
    level_db: float, ratio: float, single: float, fused: float
) -> None:
    result = scores(
        level_db,
        {
            "single": published("ryu", 36.0),
            "fused": published("ml_fusion", 36.0),
            "average only": published("ml_fusion", 7.0 * 36.0),
            "variance only": published("ryu", 36.0 / 7.0),
        },
    )
    assert result["fused"][0] / result["single"][0] <= ratio
    assert result["single"][0] == pytest.approx(single, rel=0.25)
    assert result["fused"][0] == pytest.approx(fused, rel=0.25)
    assert result["fused"][1] >= 0.9
    # The ablation: nearly all of it is the larger gain, hardly any the average.
    assert result["average only"][0] == pytest.approx(result["single"][0], rel=0.15)
    assert result["variance only"][0] <= 0.65 * result["single"][0]
