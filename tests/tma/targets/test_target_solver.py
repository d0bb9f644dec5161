"""Protects the stage of one target: sides, stations, honesty, what it refuses."""

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.evaluation.studies.tma_frequency_fusion.observability_rows import (
    target_observations,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scene_of_legs
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs
from sonar_tracking.tma.estimators.error_models import variance_factor
from sonar_tracking.tma.stations.solver_likelihoods import log_likelihoods
from sonar_tracking.tma.targets.array_sides import LEFT, RIGHT, SINGLE
from sonar_tracking.tma.targets.target_records import MAXIMUM_LINES, TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver

STRAIGHT, TURNING = (90.0,) * 4, (90.0, 0.0, 90.0, 0.0)


def one_run(scene: TmaScene, seed: int = 4) -> TmaRuns:
    return simulate_runs(scene, [np.random.SeedSequence(seed)])


def silent(scene: TmaScene) -> TmaScene:
    return replace(scene, heard=np.zeros_like(scene.heard))


@pytest.mark.slow
def test_bearings_only_is_unobservable_until_own_ship_turns() -> None:
    solver, figures = TargetSolver(), []
    for observation in target_observations(one_run(silent(scene_of_legs(TURNING, 1.0))), 0):
        (solution,) = solver.update(observation)
        figures.append(solution.observability)
        assert solution.observable == (figures[-1] >= 0.5)
    assert max(figures[20:100]) < 0.5
    assert figures[200] > 0.9
    assert solution.side == SINGLE


@pytest.mark.slow
def test_an_unobservable_range_is_not_claimed_to_be_known() -> None:
    solver = TargetSolver()
    runs = one_run(silent(scene_of_legs(STRAIGHT, 1.0)))
    for observation in target_observations(runs, 0):
        (solution,) = solver.update(observation)
    assert not solution.observable
    offset = solution.mean[:2] - observation.position
    along = offset / np.hypot(*offset)
    assert np.sqrt(along @ solution.covariance[:2, :2] @ along) > 1000.0


@pytest.mark.slow
def test_both_sides_stand_until_own_ship_turns() -> None:
    solver = TargetSolver()
    runs = one_run(silent(scene_of_legs(TURNING, 1.0)))
    for index, observation in enumerate(target_observations(runs, 0, array=True)):
        solutions = solver.update(observation)
        if index < 100:
            assert [one.side for one in solutions] == [LEFT, RIGHT]
            assert sum(one.probability for one in solutions) == pytest.approx(1.0)
        if index == 99:
            assert 0.2 < solutions[0].probability < 0.8
    assert [one.side for one in solutions] == [LEFT]
    error = solutions[0].mean - runs.truth[0, -1]
    assert error @ np.linalg.solve(solutions[0].covariance, error) < 20.0


@pytest.mark.slow
def test_a_second_station_resolves_side_and_range() -> None:
    scene = silent(scene_of_legs(STRAIGHT, 1.0))
    still = np.zeros((400, 2))
    other = replace(scene, sensor_position=still + np.array([0.0, 3000.0]), sensor_velocity=still)
    here = target_observations(one_run(scene, 1), 0, array=True, sensor="ship")
    there = target_observations(one_run(other, 1), 0, sensor="buoy")
    solver = TargetSolver()
    for first, second in zip(here, there, strict=True):
        solver.update(first)
        solutions = solver.update(second)
    (solution,) = solutions
    assert solution.side == LEFT
    truth = one_run(scene, 1).truth[0, -1]
    assert np.hypot(*(solution.mean[:2] - truth[:2])) < 100.0
    assert solution.observable


@pytest.mark.slow
def test_lines_come_and_go_without_end() -> None:
    solver = TargetSolver()
    runs = one_run(scene_of_legs(TURNING, 1.0))
    for index, observation in enumerate(target_observations(runs, 0)):
        if index < 60:
            ids = tuple(1000 * (index // 2) + number for number in observation.line_ids)
            observation = replace(observation, line_ids=ids)
        (solution,) = solver.update(observation)
        assert len(solution.line_ids) <= MAXIMUM_LINES
    heard = [number for _, number in solution.line_ids]
    for number, frequency in zip(observation.line_ids, observation.frequencies, strict=True):
        assert solution.source_frequency[heard.index(number)] == pytest.approx(frequency, abs=10.0)
    assert np.hypot(*(solution.mean[:2] - runs.truth[0, -1, :2])) < 400.0


GOOD = TargetObservation(1, "bow", (0.0, 0.0), (6.0, 0.0), (0.5,), 1e-4, (1,), (300.0,), (1.0,))


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"stamp": 0}, "older"),
        ({}, "repeats"),
        ({"position": (np.nan, 0.0)}, "odometry"),
        ({"azimuths": (np.nan,)}, "azimuths"),
        ({"azimuth_variance": -1.0}, "variance"),
        ({"frequencies": (np.nan,)}, "frequency"),
        ({"frequency_deviations": (-1.0,)}, "frequency"),
        ({"frequencies": ()}, "length"),
        (
            {"line_ids": (1, 1), "frequencies": (1.0, 2.0), "frequency_deviations": (1.0, 1.0)},
            "twice",
        ),
        ({"elevation": 0.1, "elevation_variance": 0.0}, "elevation"),
        ({"sound_speed": 0.0}, "sound speed"),
    ],
)
def test_bad_observations_are_refused_and_change_nothing(change: dict[str, Any], word: str) -> None:
    touched, untouched = TargetSolver(), TargetSolver()
    for solver in (touched, untouched):
        solver.update(GOOD)
    with pytest.raises(InputError, match=word):
        touched.update(replace(replace(GOOD, stamp=GOOD.stamp), **change))
    after = replace(GOOD, stamp=10**9)
    expected = untouched.update(after)[0]
    np.testing.assert_array_equal(touched.update(after)[0].mean, expected.mean)


def test_nothing_is_known_before_the_first_azimuth() -> None:
    solver = TargetSolver()
    assert solver.update(replace(GOOD, azimuths=())) == ()
    assert len(solver.update(replace(GOOD, stamp=10**9))) == 1


def test_a_track_that_jumps_to_another_target_is_started_anew() -> None:
    solver = TargetSolver()
    for second in range(60):
        azimuth = 0.5 if second < 40 else -2.0
        (solution,) = solver.update(replace(GOOD, stamp=second * 10**9 + 1, azimuths=(azimuth,)))
    offset = solution.mean[:2] - GOOD.position
    assert np.arctan2(offset[1], offset[0]) == pytest.approx(-2.0, abs=0.1)


@pytest.mark.slow
def test_mirror_images_are_equally_observable() -> None:
    """Own ship straight on: nothing tells the sides apart; each goes back to its own azimuth."""
    solver = TargetSolver()
    runs = one_run(scene_of_legs(STRAIGHT, 0.05))
    for seen in islice(target_observations(runs, 0, array=True), 150):
        left, right = solver.update(seen)
    assert 0.1 < left.observability < 0.99
    assert right.observability == pytest.approx(left.observability, rel=1e-6)
    np.testing.assert_allclose(right.mean * [1.0, -1.0, 1.0, -1.0], left.mean, rtol=1e-6)


def bearing_frame(
    number: int, azimuths: tuple[float, ...], course: float = 0.0, sensor: str = "bow"
) -> TargetObservation:
    return TargetObservation(
        stamp=number * 10**9,
        sensor_id=sensor,
        position=(0.0, 0.0) if sensor == "bow" else (3000.0, 0.0),
        velocity=(5.0 * np.cos(course), 5.0 * np.sin(course)),
        azimuths=azimuths,
        azimuth_variance=1e-4,
    )


@pytest.mark.parametrize(("turn_deg", "dropped"), [(19.0, False), (21.0, True), (-21.0, True)])
def test_a_side_is_dropped_only_after_a_turn_of_twenty_degrees(
    turn_deg: float, dropped: bool
) -> None:
    """However improbable it has become: the mirror image is elsewhere from the first turn on."""
    solver = TargetSolver()
    for number in range(10):
        solver.update(bearing_frame(number, (0.6, -0.6)))
    course = float(np.radians(turn_deg))
    for number in range(10, 16):
        # The target stays where it is; its mirror image about the new course turns away.
        mirrored = 2.0 * course - 0.6
        solutions = solver.update(bearing_frame(number, (0.6, mirrored), course))
    assert [one.side for one in solutions] == ([LEFT] if dropped else [LEFT, RIGHT])
    if not dropped:
        assert solutions[0].probability > 0.99


def test_the_side_of_a_line_array_is_that_of_its_azimuth() -> None:
    solutions = TargetSolver().update(bearing_frame(0, (0.6, -0.6)))
    for solution, azimuth in zip(solutions, (0.6, -0.6), strict=True):
        assert np.arctan2(solution.mean[1], solution.mean[0]) == pytest.approx(azimuth)
        assert solution.probability == pytest.approx(0.5)


def test_stamps_of_a_sensor_rise_and_those_of_several_do_not_fall() -> None:
    solver = TargetSolver()
    solver.update(bearing_frame(5, (0.6,)))
    with pytest.raises(InputError, match="repeats its stamp"):
        solver.update(bearing_frame(5, (0.6,)))
    with pytest.raises(InputError, match="older than the last one"):
        solver.update(bearing_frame(4, (0.6,), sensor="stern"))
    solver.update(bearing_frame(5, (2.4,), sensor="stern"))
    solver.update(bearing_frame(6, (0.6,)))


def test_the_first_azimuth_of_another_station_is_a_cross_fix() -> None:
    """The hypotheses are split where it cuts them: the best one is near the crossing at once."""
    target, solver = np.array([5000.0, 9000.0]), TargetSolver()
    for number in range(5):
        solver.update(bearing_frame(number, (float(np.arctan2(target[1], target[0])),)))
    offset = target - [3000.0, 0.0]
    azimuth = float(np.arctan2(offset[1], offset[0]))
    (solution,) = solver.update(bearing_frame(5, (azimuth,), sensor="stern"))
    # Bearings good to 0.57 degrees that cross at 16 degrees leave 400 m along the line of sight.
    error = solution.mean[:2] - target
    assert np.hypot(*error) < 200.0
    assert error @ np.linalg.solve(solution.covariance[:2, :2], error) < 6.0


def test_a_copy_goes_on_by_itself() -> None:
    solver = TargetSolver()
    for number in range(3):
        before = solver.update(bearing_frame(number, (0.6,)))
    copied = solver.copy()
    (moved,) = copied.update(bearing_frame(3, (0.61,)))
    (expected,) = solver.update(bearing_frame(3, (0.61,)))
    np.testing.assert_array_equal(moved.mean, expected.mean)
    assert before[0].stamp == 2 * 10**9


def test_the_likelihood_of_both_azimuths_of_a_cone_is_their_sum() -> None:
    solver = TargetSolver()
    for number in range(3):
        solver.update(bearing_frame(number, (0.6,)))

    def likelihood(*azimuths: float) -> float:
        return log_likelihoods([(solver, bearing_frame(3, azimuths))])[0]

    near = likelihood(0.6)
    assert likelihood(0.6, -0.6) == pytest.approx(near)
    assert likelihood(0.6, 0.6) == pytest.approx(near + np.log(2.0))
    assert likelihood(-0.6) == -np.inf


def test_likelihoods_found_together_are_those_found_alone() -> None:
    """Of a cone, which has two azimuths, beside a direction, which has one."""
    solver = TargetSolver()
    solver.update(bearing_frame(0, (0.6,)))
    tasks = [(solver, bearing_frame(1, azimuths)) for azimuths in ((0.6, -0.6), (0.61,))]
    alone = [log_likelihoods([task])[0] for task in tasks]
    assert log_likelihoods(tasks) == pytest.approx(alone)


@pytest.mark.slow
def test_a_target_told_wrong_begins_anew_unless_trials_or_stations_depend_on_it() -> None:
    runs = one_run(scene_of_legs(TURNING, 1.0))
    told = replace(runs, scene=replace(runs.scene, azimuth_deviation=float(np.radians(0.125))))
    observations = list(islice(target_observations(told, 0), 50))
    solver, compared, joined = TargetSolver(), TargetSolver(begins_anew=False), TargetSolver()
    for index, observation in enumerate(observations):
        solver.update(observation)
        compared.update(observation)
        joined.update(observation)
        if index == 10:
            joined.update(replace(observation, sensor_id="buoy", position=(0.0, 3000.0)))
    assert solver.state is not None and solver.state.beginning is not None
    assert solver.state.beginning.believed[0] > 3.0
    assert len(solver.state.beginning.believed) == 1 + solver.state.bank.known.size
    for other in (compared, joined):
        assert other.state is not None and other.state.beginning is None


@pytest.mark.slow
def test_bearings_of_a_line_array_told_four_times_too_good_are_found_out_on_both_sides() -> None:
    """Errors of its angle turn the azimuths of its sides opposite ways: they must not cancel."""
    runs = one_run(scene_of_legs(TURNING, 1.0))
    told = replace(runs, scene=replace(runs.scene, azimuth_deviation=float(np.radians(0.125))))
    solver = TargetSolver()
    for index, observation in enumerate(target_observations(told, 0, array=True)):
        solutions = solver.update(observation)
        if index == 40:
            assert solver.state is not None and len(solutions) == 2
            assert 8.0 < variance_factor(solver.state.errors, observation.stamp + 10**9)[0] < 32.0
    (solution,) = solutions
    error = solution.mean - runs.truth[0, -1]
    assert error @ np.linalg.solve(solution.covariance, error) < 20.0
