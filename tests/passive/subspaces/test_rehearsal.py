"""Stages can do everything once before their data: on made-up data, which leave nothing behind."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.subspaces.rehearsal import rehearsed_block, rehearsed_estimates
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_method_registry import SUBSPACE_METHODS
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage

ANGLES = np.radians([-20.0, 10.0])


@pytest.mark.parametrize("method", sorted(SUBSPACE_METHODS.names))
def test_a_made_up_block_gives_estimates(method: str) -> None:
    configuration = SubspaceConfiguration(method=method, source_count=2)
    update = SubspaceStage(configuration).update(rehearsed_block(2, 400, configuration.period))
    assert update.estimates


def test_made_up_estimates_start_the_tracks_of_their_sources() -> None:
    tracker = BearingTrackerStage(BearingTrackerConfiguration())
    for second in range(5):
        tracks = tracker.update(rehearsed_estimates(ANGLES, "covariance", second)).tracks
    np.testing.assert_allclose(np.sort(tracks.arrival_angle), ANGLES, atol=np.radians(1.0))


def test_a_stage_that_is_warm_gives_what_a_cold_one_gives() -> None:
    warm, cold = (BearingTrackerStage(BearingTrackerConfiguration()) for _ in range(2))
    warm.warm_up()
    for second in range(5):
        estimates = rehearsed_estimates(ANGLES, "covariance", second)
        ours, theirs = (stage.update(estimates).tracks for stage in (warm, cold))
        np.testing.assert_array_equal(ours.id, theirs.id)
        np.testing.assert_array_equal(ours.arrival_angle, theirs.arrival_angle)
    configuration = SubspaceConfiguration()
    block = rehearsed_block(0, 400, configuration.period)
    one, other = SubspaceStage(configuration), SubspaceStage(configuration)
    one.warm_up()
    for after, without in zip(
        one.update(block).estimates, other.update(block).estimates, strict=True
    ):
        np.testing.assert_array_equal(after.basis, without.basis)
