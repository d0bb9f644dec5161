"""Tracks of faint sources in the whole bearing chain: started, held, ended, and none of noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.run_synthesis import long_blocks
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerStage,
    update_together,
)
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.passive.subspaces.unfollowed_subspace import UnfollowedSubspace
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates, TrackStatus
from sonar_tracking.simulation.scenarios.array_configuration import ArrayConfiguration
from sonar_tracking.simulation.scenarios.bearing_motion import LinearMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.target import TargetConfiguration

DURATION = 60.0


def source(
    level_db: float, bearing_deg: float = -20.0, until: float = DURATION
) -> TargetConfiguration:
    motion = LinearMotion(offset_deg=bearing_deg, rate_deg=0.2)
    return TargetConfiguration(level_db=level_db, motion=motion, present=(0.0, until))


def estimates_of(
    *targets: TargetConfiguration, duration: float = DURATION, seed: int = 1
) -> list[SubspaceEstimates]:
    scenario = Scenario(
        duration=duration,
        array=ArrayConfiguration(n_elements=15, bandwidth=100.0),
        targets=targets or (source(-90.0),),
    )
    stage = SubspaceStage(SubspaceConfiguration(), UnfollowedSubspace())
    return [
        estimate
        for block in long_blocks(scenario, (seed,), 1000)
        for estimate in stage.update(replace(block, data=block.data[0])).estimates
    ]


def tracked(
    estimates: Sequence[SubspaceEstimates], track_before_detect: bool = True
) -> list[BearingTracks]:
    configuration = BearingTrackerConfiguration(track_before_detect=track_before_detect)
    stage = BearingTrackerStage(configuration)
    return [stage.update(each).tracks for each in estimates]


def confirmed(tracks: Sequence[BearingTracks]) -> list[int]:
    """Return how many confirmed tracks there are at each time."""
    return [int(np.count_nonzero(each.status == TrackStatus.CONFIRMED)) for each in tracks]


def angle_at_end(tracks: Sequence[BearingTracks], row: int = 0) -> float:
    return float(np.degrees(tracks[-1].arrival_angle[row]))


@pytest.fixture(scope="module")
def faint() -> list[SubspaceEstimates]:
    return estimates_of(source(-15.0))


@pytest.mark.slow
def test_a_source_that_no_covariance_shows_gets_one_track_and_keeps_it(
    faint: list[SubspaceEstimates],
) -> None:
    assert np.mean([each.rank for each in faint]) < 0.1
    tracks = tracked(faint)
    counts = confirmed(tracks)
    first = counts.index(1)
    assert first < 40 and set(counts[first:]) == {1}
    assert len({int(name) for each in tracks for name in each.id}) == 1
    errors = [
        (each.arrival_angle[0] - np.radians(-20.0 + 0.2 * 0.5 * number), each.covariance[0, 0, 0])
        for number, each in enumerate(tracks[first:], first)
    ]
    assert np.mean([error**2 / variance for error, variance in errors]) < 3.0
    assert np.degrees(np.sqrt(np.mean([error**2 for error, _ in errors]))) < 1.0


def test_without_track_before_detect_it_gets_none(faint: list[SubspaceEstimates]) -> None:
    assert max(confirmed(tracked(faint, track_before_detect=False))) == 0


@pytest.mark.slow
def test_runs_together_are_as_each_by_itself(faint: list[SubspaceEstimates]) -> None:
    others = estimates_of(source(-12.0, 10.0), seed=2)
    stages = [BearingTrackerStage(BearingTrackerConfiguration()) for _ in range(2)]
    together = [update_together(stages, pair) for pair in zip(faint, others, strict=True)]
    for run, alone in enumerate((tracked(faint), tracked(others))):
        for one, both in zip(alone, together, strict=True):
            assert one.id.tolist() == both[run].tracks.id.tolist()
            assert one.arrival_angle == pytest.approx(both[run].tracks.arrival_angle, abs=1e-9)


@pytest.mark.slow
def test_its_track_ends_when_it_falls_silent() -> None:
    counts = confirmed(tracked(estimates_of(source(-14.0, until=30.0))))
    assert counts[58] == 1 and counts[-1] == 0


@pytest.mark.slow
def test_noise_gets_no_track() -> None:
    for seed in (1, 2):
        assert max(confirmed(tracked(estimates_of(duration=120.0, seed=seed)))) == 0


@pytest.mark.slow
def test_faint_sources_are_found_beside_others_unless_these_are_loud() -> None:
    """Echoes of a loud source are as strong as a faint source: they get no tracks."""
    for level_db, expected in ((-6.0, 2), (10.0, 1)):
        counts = confirmed(tracked(estimates_of(source(level_db, 30.0), source(-13.0))))
        assert counts[-2] == expected


@pytest.mark.slow
def test_a_strong_source_starts_beside_a_faint_track_as_soon_as_ever() -> None:
    late = replace(source(0.0, 30.0), present=(30.0, DURATION))
    counts = confirmed(tracked(estimates_of(source(-14.0), late)))
    assert counts[58] == 1 and 2 in counts[60:68] and counts[-2] == 2
