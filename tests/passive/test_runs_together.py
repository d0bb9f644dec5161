"""Protects: runs that are computed at once give what each of them gives by itself, bit for bit."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import line_array
from sonar_tracking.passive.bearings import bearing_tracker_stage
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces import subspace_stage
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.passive.subspaces.unfollowed_subspace import UnfollowedSubspace
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks, SubspaceEstimates
from tests.passive.crossing_scene import blocks_of, crossing_angles, snapshots_of

ESTIMATOR = SubspaceConfiguration(method="covariance", source_count=0, period=0.5)
TRACKER = BearingTrackerConfiguration(method="joint_map")
METHODS = {
    "joint_map": (ESTIMATOR, TRACKER),
    "coherent": (ESTIMATOR, replace(TRACKER, method="coherent")),
    "ml_fusion": (
        SubspaceConfiguration(method="past", source_count=5, period=0.5),
        replace(TRACKER, method="ml_fusion"),
    ),
}
SIZE = 100
"""Snapshots in a block."""


def runs(n_elements: int = 15) -> list[list[ArraySnapshots]]:
    """Return the blocks of runs with five, five, two and no targets at other levels."""
    positions = line_array(n_elements, 0.5)
    angles = crossing_angles(np.arange(1200) / 200.0 + 20.0)
    made = []
    for seed, (n_targets, level_db) in enumerate([(5, 3.0), (5, -5.0), (2, 0.0), (0, 0.0)]):
        generator = np.random.default_rng(seed)
        data = snapshots_of(generator, angles[:, :n_targets], level_db, positions=positions)
        made.append(
            list(blocks_of(data, SIZE, end=True, element_positions=positions, bandwidth=1.0))
        )
    made[1][4] = replace(made[1][4], data=np.zeros_like(made[1][4].data))
    return made


def known(entries: list[SubspaceEstimates] | list[BearingTracks]) -> list[list[object]]:
    """Return everything in records: arrays as bytes, the rest in writing, since it may be NaN."""
    return [
        [
            value.tobytes() if isinstance(value, np.ndarray) else repr(value)
            for value in (getattr(entry, each.name) for each in fields(entry))
        ]
        for entry in entries
    ]


def estimates_alone(
    configuration: SubspaceConfiguration, blocks: list[ArraySnapshots]
) -> list[SubspaceEstimates]:
    stage = SubspaceStage(configuration)
    return [each for block in blocks for each in stage.update(block).estimates]


@pytest.mark.slow
@pytest.mark.parametrize("n_elements", [15, 51])
def test_estimates_of_runs_together_are_those_of_each(n_elements: int) -> None:
    blocks = runs(n_elements)
    stages = [SubspaceStage(ESTIMATOR) for _ in blocks]
    together: list[list[SubspaceEstimates]] = [[] for _ in blocks]
    for now in zip(*blocks, strict=True):
        for own, update in zip(together, subspace_stage.update_together(stages, now), strict=True):
            own.extend(update.estimates)
    for own, alone in zip(together, blocks, strict=True):
        assert known(own) == known(estimates_alone(ESTIMATOR, alone))


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_tracks_of_runs_together_are_those_of_each(method: str) -> None:
    estimator, tracker = METHODS[method]
    estimates = [estimates_alone(estimator, blocks) for blocks in runs()]
    together: list[list[BearingTracks]] = [[] for _ in estimates]
    trackers = [BearingTrackerStage(tracker) for _ in estimates]
    for now in zip(*estimates, strict=True):
        updates = bearing_tracker_stage.update_together(trackers, now)
        for own, update in zip(together, updates, strict=True):
            own.append(update.tracks)
    for own, single in zip(together, estimates, strict=True):
        alone = BearingTrackerStage(tracker)
        assert known(own) == known([alone.update(each).tracks for each in single])
    assert any(entry.established.any() for entry in together[0])


@pytest.mark.slow
def test_where_nobody_looks_at_the_subspace_all_else_is_the_same() -> None:
    blocks = runs()[0]
    stage = SubspaceStage(ESTIMATOR, UnfollowedSubspace())
    tracker, other = BearingTrackerStage(TRACKER), BearingTrackerStage(TRACKER)
    unfollowed = [each for block in blocks for each in stage.update(block).estimates]
    followed = estimates_alone(ESTIMATOR, blocks)
    assert not np.array_equal(unfollowed[-1].basis, followed[-1].basis)
    alike = [replace(own, basis=each.basis) for own, each in zip(unfollowed, followed, strict=True)]
    assert known(alike) == known(followed)
    tracks = [
        [at.update(each).tracks for each in of]
        for at, of in ((tracker, unfollowed), (other, followed))
    ]
    assert known(tracks[0]) == known(tracks[1])


@pytest.mark.slow
def test_bad_data_of_one_run_change_none() -> None:
    blocks = runs()
    stages = [SubspaceStage(ESTIMATOR) for _ in blocks]
    trackers = [BearingTrackerStage(TRACKER) for _ in blocks]
    bad = np.full_like(blocks[2][0].data, np.nan)
    spoilt = [blocks[0][0], blocks[1][0], replace(blocks[2][0], data=bad), blocks[3][0]]
    with pytest.raises(InputError, match="not a finite number"):
        subspace_stage.update_together(stages, spoilt)
    for now in zip(*(own[:2] for own in blocks), strict=True):
        made = subspace_stage.update_together(stages, now)
    assert [len(update.estimates) for update in made] == [1, 1, 1, 1]
    estimates = list(zip(*(estimates_alone(ESTIMATOR, own) for own in blocks), strict=True))
    bearing_tracker_stage.update_together(trackers, estimates[0])
    late = [*estimates[1][:3], estimates[0][3]]
    with pytest.raises(InputError, match="earlier"):
        bearing_tracker_stage.update_together(trackers, late)
    again = bearing_tracker_stage.update_together(trackers, estimates[1])
    assert all(update.tracks.stamp == estimates[1][0].stamp for update in again)
