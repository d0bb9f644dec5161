"""Protects how targets of three and more stations are found to be one: where all bearings meet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.target import TargetConfiguration
from sonar_tracking.tma.stations.station_crossings import certain_crossings, pointed_at
from sonar_tracking.tma.stations.station_pairing import StationPairing
from sonar_tracking.tma.stations.station_trials import LEAST_BEARINGS, Trial
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import SECOND, listed, running, scene, simulated

BUOYS = tuple(
    BearingSensorConfiguration(
        sensor_id=f"buoy_{number}",
        namespace=f"buoy_{number}",
        platform="fixed",
        position=place,
        angle_kind="azimuth",
        frame_interval=4.0,
    )
    for number, place in enumerate([(0.0, 0.0), (4000.0, 0.0), (0.0, 4500.0), (4200.0, 4500.0)])
)
SHIPS = tuple(
    TargetConfiguration(
        name=f"ship {number}",
        motion=KinematicMotion(position=place, course_deg=course, speed=speed),
    )
    for number, (place, course, speed) in enumerate(
        [
            ((-3000.0, 3000.0), 80.0, 6.0),
            ((1000.0, 6500.0), 200.0, 5.0),
            ((5000.0, 2500.0), 280.0, 3.0),
            ((2500.0, -2500.0), 330.0, 4.0),
        ]
    )
)


def last_picture(
    count: int, deviation: float, duration: float
) -> tuple[PositionTracks, FloatArray]:
    """Return the last list that so many buoys make of all ships, and where these are."""
    sensors = [replace(one, angle_standard_deviation_deg=deviation) for one in BUOYS[:count]]
    stage = TmaTrackerStage(TmaTrackerConfiguration(), n_stations=count)
    frames = simulated(scene(*sensors, targets=SHIPS, duration=duration, seed=2))
    updates = [stage.update(frame) for frame, _ in frames]
    return running(listed(updates[-1])), frames[-1][1].truth_tracks.position


@pytest.mark.slow
@pytest.mark.parametrize(("count", "deviation", "duration"), [(3, 0.5, 120.0), (4, 0.5, 60.0)])
def test_all_ships_are_rows_of_all_stations_within_a_minute_or_so(
    count: int, deviation: float, duration: float
) -> None:
    """Two stations alone have sixteen crossings of four ships, and few fall behind in that time."""
    tracks, truth = last_picture(count, deviation, duration)
    assert len(tracks) == len(SHIPS)
    distance = np.hypot(*(tracks.state[:, None, :2] - truth).transpose(2, 0, 1))
    assert sorted(distance.argmin(axis=1)) == list(range(len(SHIPS)))
    assert distance.min(axis=1).max() < 150.0
    for row in range(len(SHIPS)):
        own = tracks.contributor_track == row
        assert len({tracks.contributor_sensor[n] for n in np.flatnonzero(own)}) == count
        assert len(set(tracks.contributor_id[own].tolist())) == 1, "each ship has one number"


def named(*names: str) -> list[FollowedTarget]:
    return [FollowedTarget(TargetSolver(), {name: 1}, 0, 0, 1) for name in names]


def trial(evidence: float, *targets: FollowedTarget, bearings: int = LEAST_BEARINGS) -> Trial:
    return Trial(targets, TargetSolver(), evidence, bearings=bearings)


def test_of_all_explanations_the_best_must_lead_by_the_odds() -> None:
    a, b, c, d = named("one", "two", "three", "two")
    best, rival = trial(12.0, a, b, c), trial(8.0, a, d, c)
    assert certain_crossings([best, rival], 4.0) == [best]
    assert certain_crossings([best, rival], 5.0) == []
    # That the other is of something else, too, speaks for both.
    e, f = named("one", "three")
    other = trial(6.0, e, d, f)
    assert certain_crossings([best, rival, other], 5.0) == [best, other]


def test_a_part_that_is_common_to_all_explanations_is_certain_first() -> None:
    a, b, c, d = named("one", "two", "three", "three")
    pair, first, second = trial(6.0, a, b), trial(11.0, a, b, c), trial(10.0, a, b, d)
    assert certain_crossings([pair, first, second], 4.6) == [pair]
    assert certain_crossings([pair, first], 4.6) == [first]


def test_agile_and_straight_trials_of_the_same_targets_are_no_rivals() -> None:
    a, b, c = named("one", "two", "three")
    straight, agile = trial(9.0, a, b, c), trial(8.9, a, b, c)
    agile.agile = True
    assert certain_crossings([straight, agile], 4.6) == [straight]


def test_a_coincidence_of_a_few_bearings_is_not_certain() -> None:
    a, b, c = named("one", "two", "three")
    assert certain_crossings([trial(20.0, a, b, c, bearings=LEAST_BEARINGS - 1)], 4.6) == []


def test_a_pair_that_was_pointed_to_waits_for_as_many_bearings() -> None:
    """One that is tried from birth does not: its first bearing was at no chosen time."""
    a, b = named("one", "two")
    cases = ((1, LEAST_BEARINGS - 1, False), (1, LEAST_BEARINGS, True), (0, 1, True))
    for begun, bearings, is_one in cases:
        pairing = StationPairing(100.0)
        tried = trial(20.0, a, b, bearings=bearings)
        tried.begun = begun
        pairing._trials = [tried]
        assert [(one.first, one.second) for one in pairing.decide(SECOND)] == [(a, b)] * is_one


def seen_from(sensor: str, place: tuple[float, float], stamp: int, at: float) -> TargetObservation:
    """Return an azimuth, degrees, that a sensor tells."""
    return TargetObservation(
        stamp=stamp * SECOND,
        sensor_id=sensor,
        position=place,
        velocity=(0.0, 0.0),
        azimuths=(float(np.radians(at)),),
        azimuth_variance=float(np.radians(0.5) ** 2),
    )


def test_where_a_target_points_to_another_is_tried_and_elsewhere_is_told() -> None:
    """Two stations have a target at 3 km, 3 km; a third one hears something there, or not."""
    (target,) = named("one")
    target.members["two"] = 1
    for number in range(0, 40, 2):
        target.solver.update(seen_from("one", (0.0, 0.0), number, 45.0))
        target.solver.update(seen_from("two", (6000.0, 0.0), number + 1, 135.0))
    for direction, is_there in ((0.0, True), (20.0, False)):
        (other,) = named("three")
        for number in range(36, 40):
            seen = seen_from("three", (0.0, 3000.0), number, direction)
            other.solutions = other.solver.update(seen)
        look = [(other, seen_from("three", (0.0, 3000.0), 40, direction))]
        begun, elsewhere = pointed_at([], [target], look, set(), 0.0)
        assert [set(one.targets) for one in begun] == ([{target, other}] if is_there else [])
        assert [set(key[0]) for key in elsewhere] == ([] if is_there else [{target, other}])
        known = {(frozenset((target, other)), False)}
        assert pointed_at([], [target], look, known, 0.0) == ([], set())
