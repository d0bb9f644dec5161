"""Bearing tracks of several runs of one scene, tracked at once: the same bits in less time."""

from __future__ import annotations

from collections.abc import Sequence

from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import update_together as tracks_together
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.passive.subspaces.subspace_stage import update_together as subspaces_together
from sonar_tracking.records.bearings import BearingTracks
from tests.passive.crossing_scene import EPOCH, ComplexArray, blocks_of


def tracked_together(
    runs: Sequence[ComplexArray],
    subspaces: SubspaceConfiguration,
    configuration: BearingTrackerConfiguration,
    size: int = 20,
    start: int = EPOCH - 1_000_000_000,
) -> list[list[BearingTracks]]:
    """Return the tracks of snapshots of equal shape, cut into blocks of a size, run by run."""
    stages = [SubspaceStage(subspaces) for _ in runs]
    trackers = [BearingTrackerStage(configuration) for _ in runs]
    tracks: list[list[BearingTracks]] = [[] for _ in runs]
    for blocks in zip(*(blocks_of(data, size, start) for data in runs), strict=True):
        updates = subspaces_together(stages, blocks)
        for estimates in zip(*(update.estimates for update in updates), strict=True):
            for own, update in zip(tracks, tracks_together(trackers, estimates), strict=True):
                own.append(update.tracks)
    return tracks
