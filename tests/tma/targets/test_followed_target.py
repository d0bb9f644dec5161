"""Protects what a target says of itself: confirmed, coasted, misfits, its best side, its row."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import TrackHypothesis, TrackSource
from sonar_tracking.tma.targets.array_sides import LEFT, RIGHT, SINGLE
from sonar_tracking.tma.targets.baseline_solver import BaselineSolver
from sonar_tracking.tma.targets.followed_target import FollowedTarget, new_solver
from sonar_tracking.tma.targets.systematic_errors import Sight
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.target_solver import TargetSolver
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.track_rows import track_list, track_row

SECOND = 1_000_000_000
CONFIGURATION = TmaTrackerConfiguration(
    confirm_observability=0.5,
    confirm_relative_deviation=0.1,
    coasted_after=10.0,
    sound_speed_variation=0.0,
    target_size=0.0,
)


def solution(**changes: Any) -> TargetSolution:
    """Return a solution 1000 m east of the origin, known to 50 m at worst."""
    values: dict[str, Any] = {
        "stamp": 20 * SECOND,
        "side": SINGLE,
        "probability": 1.0,
        "mean": np.array([1000.0, 0.0, 2.0, -1.0]),
        "covariance": np.diag([2500.0, 100.0, 1.0, 1.0]),
        "observability": 0.9,
        "observable": True,
        "line_ids": (("bow", 3), ("bow", 9)),
        "source_frequency": np.array([300.0, 0.0]),
        "source_frequency_deviation": np.array([0.1, 0.2]),
        "manoeuvre": False,
    }
    return TargetSolution(**{**values, **changes})


def target(*solutions: TargetSolution, **changes: Any) -> FollowedTarget:
    values: dict[str, Any] = {
        "solver": TargetSolver(),
        "members": {"bow": 4},
        "initiated": 5 * SECOND,
        "updated": 20 * SECOND,
        "bearing_track_id": 4,
        "solutions": solutions,
        "row_of": {SINGLE: 11, LEFT: 12, RIGHT: 13},
    }
    return FollowedTarget(**{**values, **changes})


def sight(position: tuple[float, float], second: int = 20) -> Sight:
    return Sight(position, 0.0, 0.0, elevated=False, stamp=second * SECOND)


def test_the_best_solution_is_the_most_probable() -> None:
    left, right = solution(side=LEFT, probability=0.3), solution(side=RIGHT, probability=0.7)
    assert target(left, right).best is right
    assert target(right, left).best is right


@pytest.mark.parametrize(
    ("deviation", "observability", "place", "confirmed"),
    [
        (99.0, 0.9, (0.0, 0.0), True),
        (101.0, 0.9, (0.0, 0.0), False),  # a tenth of 1000 m
        (99.0, 0.49, (0.0, 0.0), False),
        (99.0, 0.5, (0.0, 0.0), True),
        (99.0, 0.9, (100.0, 0.0), False),  # from 900 m it would have to be 90 m
        (99.0, 0.9, (1000.0, -1000.0), True),
    ],
)
def test_a_solution_is_confirmed_when_it_is_observable_and_known_to_a_tenth_of_its_range(
    deviation: float, observability: float, place: tuple[float, float], confirmed: bool
) -> None:
    # The larger axis of the ellipse counts, whichever way it lies.
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    covariance = np.eye(4)
    covariance[:2, :2] = turn @ np.diag([deviation**2, 4.0]) @ turn.T
    made = target(
        solution(covariance=covariance, observability=observability), sights={"bow": sight(place)}
    )
    made.judge(CONFIGURATION)
    assert made.confirmed == confirmed


@pytest.mark.parametrize(
    ("deviation", "observability", "confirmed"),
    [(199.0, 0.5, True), (201.0, 0.5, False), (50.0, 0.4, False)],
)
def test_what_is_confirmed_stays_so_until_it_is_unobservable_or_half_as_well_known(
    deviation: float, observability: float, confirmed: bool
) -> None:
    covariance = np.diag([deviation**2, 100.0, 1.0, 1.0])
    one = solution(covariance=covariance, observability=observability)
    made = target(one, confirmed=True)
    made.judge(CONFIGURATION)
    assert made.confirmed == confirmed


def test_the_range_is_that_from_the_farthest_station_whichever_has_observed_it_last() -> None:
    """A deviation of 150 m is good enough at 2 km and not at 1 km."""
    covariance = np.diag([150.0**2, 100.0, 1.0, 1.0])
    for places in ({"near": (0.0, 0.0), "far": (-1000.0, 0.0)}, {"near": (0.0, 0.0)}):
        sights = {name: sight(place) for name, place in places.items()}
        made = target(solution(covariance=covariance), sights=sights)
        made.judge(CONFIGURATION)
        assert made.confirmed == ("far" in places)


def test_constant_errors_of_the_stations_are_added_once_and_not_to_methods_for_comparison() -> None:
    """Half a degree across the line of sight, 1000 m away."""
    made, one = target(sights={"bow": sight((0.0, 0.0))}), solution()
    made.take((one,), CONFIGURATION)
    (taken,) = made.solutions
    added = taken.covariance - one.covariance
    assert added == pytest.approx(np.diag([0.0, (1000.0 * np.radians(0.5)) ** 2, 0.0, 0.0]))
    made.take(made.solutions, CONFIGURATION)
    assert made.solutions == (taken,)
    for other in (
        replace(CONFIGURATION, systematic_deviation_deg=0.0),
        replace(CONFIGURATION, method="fused_line"),
    ):
        made.take((one,), other)
        assert made.solutions == (one,)


def test_a_station_that_has_been_silent_for_long_does_not_count() -> None:
    made, one = target(), solution()
    made.sights = {"bow": sight((0.0, 0.0), 400), "stern": sight((1000.0, 500.0), 50)}
    made.take((one,), CONFIGURATION)
    alone = made.solutions[0].covariance
    made.sights["stern"] = sight((1000.0, 500.0), 150)
    made.take((one,), CONFIGURATION)
    assert alone[0, 0] == one.covariance[0, 0] < made.solutions[0].covariance[0, 0]


def test_without_a_solution_nothing_is_judged() -> None:
    nothing = target(confirmed=True)
    nothing.judge(CONFIGURATION)
    assert nothing.confirmed


@pytest.mark.parametrize(
    ("changes", "stamp", "probability", "status"),
    [
        ({}, 30, 1.0, TrackStatus.TENTATIVE),
        ({"confirmed": True}, 30, 1.0, TrackStatus.CONFIRMED),
        ({"confirmed": True}, 30, 0.99, TrackStatus.TENTATIVE),
        ({"confirmed": True}, 30, 0.991, TrackStatus.CONFIRMED),
        ({"confirmed": True}, 31, 1.0, TrackStatus.COASTED),
        ({"confirmed": True, "members": {}}, 20, 1.0, TrackStatus.COASTED),
        ({"members": {}}, 99, 1.0, TrackStatus.TENTATIVE),
    ],
)
def test_a_row_is_confirmed_with_its_side_and_coasted_after_ten_seconds(
    changes: dict[str, Any], stamp: int, probability: float, status: TrackStatus
) -> None:
    made = target(solution(), **changes)
    found = made.status(solution(probability=probability), stamp * SECOND, CONFIGURATION)
    assert found == status


def observation(stamp: int, *azimuths: float) -> TargetObservation:
    return TargetObservation(stamp, "stern", (7.0, 8.0), (0.0, 0.0), azimuths, 1e-4)


def test_misfits_of_a_station_are_counted_in_a_row() -> None:
    made = target(members={"bow": 4, "stern": 2})
    for expected in (1, 2):
        made.weigh("stern", -np.inf)
        assert made.misfits == {"stern": expected}
    made.weigh("bow", -np.inf)
    assert made.misfits == {"stern": 2, "bow": 1}
    made.weigh("stern", -50.0)
    assert made.misfits == {"stern": 0, "bow": 1}


def test_an_observation_that_is_taken_in_moves_stamp_and_place() -> None:
    before, after = solution(), solution(stamp=30 * SECOND)
    made = target(before)
    assert made.conclude(observation(30 * SECOND, 0.1), ()) == (before,)
    assert (made.updated, made.sights) == (20 * SECOND, {})
    assert made.conclude(observation(30 * SECOND), (after,)) == (after,)
    assert (made.updated, made.sights) == (30 * SECOND, {})
    made.conclude(observation(31 * SECOND, 0.1), (after,))
    assert (made.updated, made.sights) == (31 * SECOND, {"stern": sight((7.0, 8.0), 31)})


def refusing(count: int) -> TargetSolver:
    """Return a solver that has refused so many azimuths in a row, after some that it accepted."""
    solver = TargetSolver()
    for number in range(4 + count):
        azimuth = 0.1 if number < 4 else 2.0
        solver.update(observation((21 + number) * SECOND, azimuth))
    return solver


def test_an_azimuth_that_is_refused_is_no_measurement_of_the_target() -> None:
    after = solution(stamp=30 * SECOND)
    made = target(solution(), solver=refusing(1))
    made.conclude(observation(30 * SECOND, 2.0), (after,))
    assert made.updated == 20 * SECOND
    heard = replace(
        observation(30 * SECOND, 2.0),
        line_ids=(1,),
        frequencies=(300.0,),
        frequency_deviations=(0.1,),
    )
    made.conclude(heard, (after,))
    assert made.updated == 30 * SECOND


@pytest.mark.parametrize(("count", "misled"), [(4, False), (5, True)])
def test_a_target_is_misled_by_five_azimuths_that_it_refuses(count: int, misled: bool) -> None:
    made = target(solution(), solver=refusing(count), confirmed=True)
    assert made.misled == misled
    short, long = CONFIGURATION, replace(CONFIGURATION, coast_duration=300.0)
    assert made.patience(short) == 0.0
    made.forsake(20 * SECOND)
    assert not made.misled and not made.members
    assert (made.patience(short), made.patience(long)) == (60.0, 300.0)


def test_the_solver_is_that_of_the_method() -> None:
    assert isinstance(new_solver(TmaTrackerConfiguration()), TargetSolver)
    assert isinstance(new_solver(TmaTrackerConfiguration(method="fused_line")), BaselineSolver)


def test_mirror_images_are_equally_observable_to_a_method_for_comparison() -> None:
    """Each side goes back to its own azimuth; own ship goes straight on."""
    solver = BaselineSolver(TmaTrackerConfiguration(method="fused_line"))
    alone = BaselineSolver(TmaTrackerConfiguration(method="fused_line"))
    for number in range(40):
        azimuth = 0.4 + 0.01 * number
        seen = TargetObservation(
            stamp=(1 + number) * SECOND,
            sensor_id="bow",
            position=(5.0 * number, 0.0),
            velocity=(5.0, 0.0),
            azimuths=(azimuth, -azimuth),
            azimuth_variance=1e-4,
            line_ids=(1,),
            frequencies=(300.0,),
            frequency_deviations=(0.1,),
        )
        left, right = solver.update(seen)
        (single,) = alone.update(replace(seen, azimuths=(azimuth,)))
    assert (left.side, right.side) == (LEFT, RIGHT)
    assert left.observability == pytest.approx(single.observability, rel=1e-9)
    assert 0.01 < left.observability < 0.99
    assert right.observability == pytest.approx(left.observability, rel=1e-6)


def test_a_row_is_predicted_to_the_stamp_of_the_list() -> None:
    made = target(solution(), existence_probability=0.8)
    late = track_row(made, made.best, TrackStatus.CONFIRMED, 24 * SECOND, 0.05)
    motion = np.eye(4) + 4.0 * np.eye(4, k=2)
    noise = 0.05**2 * np.kron(np.array([[64.0 / 3.0, 8.0], [8.0, 4.0]]), np.eye(2))
    assert late.state == pytest.approx([1008.0, -4.0, 2.0, -1.0])
    assert late.covariance == pytest.approx(motion @ made.best.covariance @ motion.T + noise)
    for stamp in (20 * SECOND, 19 * SECOND):
        now = track_row(made, made.best, TrackStatus.CONFIRMED, stamp, 0.05)
        np.testing.assert_array_equal(now.state, made.best.mean)
        np.testing.assert_array_equal(now.covariance, made.best.covariance)


def test_the_list_holds_every_row_with_its_lines_and_contributors() -> None:
    one = target(solution(), existence_probability=0.8)
    sides = (
        solution(side=LEFT, probability=0.3, observability=0.2),
        solution(
            side=RIGHT,
            probability=0.7,
            line_ids=(),
            source_frequency=np.zeros(0),
            source_frequency_deviation=np.zeros(0),
        ),
    )
    two = target(*sides, members={"bow": 5, "stern": 6}, bearing_track_id=5)
    rows = [
        track_row(made, each, status, 20 * SECOND, 0.05)
        for made, each, status in (
            (one, one.best, TrackStatus.CONFIRMED),
            (two, sides[0], TrackStatus.TENTATIVE),
            (two, sides[1], TrackStatus.COASTED),
        )
    ]
    tracks = track_list(rows, 20 * SECOND, 21 * SECOND)
    assert (tracks.stamp, tracks.next_stamp) == (20 * SECOND, 21 * SECOND)
    assert tracks.id.tolist() == [11, 12, 13]
    assert tracks.source.tolist() == [TrackSource.TMA] * 3
    assert tracks.status.tolist() == [
        TrackStatus.CONFIRMED,
        TrackStatus.TENTATIVE,
        TrackStatus.COASTED,
    ]
    assert tracks.existence_probability == pytest.approx([0.8, np.nan, np.nan], nan_ok=True)
    assert (tracks.initiated.tolist(), tracks.updated.tolist()) == ([5.0] * 3, [20.0] * 3)
    assert tracks.bearing_track_id.tolist() == [4, 5, 5]
    assert tracks.observability.tolist() == [0.9, 0.2, 0.9]
    assert tracks.hypothesis.tolist() == [
        TrackHypothesis.SINGLE,
        TrackHypothesis.LEFT,
        TrackHypothesis.RIGHT,
    ]
    assert tracks.hypothesis_probability.tolist() == [1.0, 0.3, 0.7]
    # A line never heard has the frequency 0 and is left out.
    assert tracks.line_track.tolist() == [0, 1]
    assert tracks.line_id.tolist() == [3, 3]
    assert tracks.line_frequency.tolist() == [300.0, 300.0]
    assert tracks.line_frequency_standard_deviation.tolist() == [0.1, 0.1]
    assert tracks.contributor_track.tolist() == [0, 1, 1, 2, 2]
    assert tracks.contributor_id.tolist() == [4, 5, 6, 5, 6]
    assert tracks.contributor_sensor == ("bow", "bow", "stern", "bow", "stern")
    assert track_list([], 1, 2).state.shape == (0, 4)


def test_rows_are_not_changed_by_those_made_of_them() -> None:
    made = target(solution())
    copy = replace(made.best, covariance=made.best.covariance.copy())
    track_row(made, made.best, TrackStatus.CONFIRMED, 30 * SECOND, 0.05)
    np.testing.assert_array_equal(made.best.covariance, copy.covariance)


def test_what_falls_silent_is_coasted_and_may_have_stopped() -> None:
    """Of a ship of 5 m/s, 30 s after its bearings became thirty times as bad as usual."""
    one = solution(mean=np.array([1000.0, 0.0, 3.0, 4.0]))
    made = target(one, updated=0, confirmed=True)
    for second in range(200):
        deviation = np.radians(1.0 if second < 150 else 30.0)
        seen = TargetObservation(
            second * SECOND, "bow", (0.0, 0.0), (0.0, 0.0), (0.0,), float(deviation**2)
        )
        made.hearing.take(seen)
        made.conclude(seen, (one,))
    assert 150 <= made.updated / SECOND < 160
    stamp = made.updated + 30 * SECOND
    one = replace(one, stamp=stamp)
    assert made.status(one, stamp, CONFIGURATION) == TrackStatus.COASTED
    row = track_row(made, one, TrackStatus.COASTED, stamp, 0.01)
    stopped = np.array([-30.0 * 3.0, -30.0 * 4.0, -3.0, -4.0])
    added = row.covariance - one.covariance
    assert np.trace(added[:2, :2]) == pytest.approx(stopped[:2] @ stopped[:2])
    assert np.trace(added[2:, 2:]) == pytest.approx(stopped[2:] @ stopped[2:])
    heard = track_row(made, one, TrackStatus.CONFIRMED, stamp, 0.01)
    assert heard.covariance == pytest.approx(one.covariance)
