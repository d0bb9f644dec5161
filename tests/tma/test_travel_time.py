"""Protects the travel time of sound: a target is heard where it was, and reported where it is."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.motion import Trajectory, emission_times
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.tma.estimators.hypothesis_bank import start_bank
from sonar_tracking.tma.estimators.measurement_model import linearise
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.estimators.travel_time import offset_seen
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import (
    DIRECTIONS,
    NEAR,
    error_of,
    fed_together,
    listed,
    scene,
    simulated,
)

STATE = np.array([4000.0, 3000.0, -8.0, 6.0, 300.0])
MEASUREMENT = TmaMeasurement(
    stamp=0,
    position=np.array([500.0, -200.0]),
    velocity=np.array([3.0, 1.0]),
    azimuth=np.array([0.7]),
    azimuth_variance=np.array(1e-4),
    frequency=np.array([300.5]),
    frequency_deviation=np.array([0.1]),
    propagation_speed=1500.0,
)
KNOWN = np.ones(1, dtype=bool)


def test_the_place_heard_is_that_of_the_emission() -> None:
    offset, delay = offset_seen(STATE[None, :4], MEASUREMENT.position, 1500.0)
    course = float(np.arctan2(STATE[3], STATE[2]))
    path = Trajectory((4000.0, 3000.0), course, float(np.hypot(*STATE[2:4])))
    emitted = emission_times(path, MEASUREMENT.position, 0.0, 1500.0)
    assert delay[0] == pytest.approx(-emitted, rel=1e-4)
    assert offset[0] == pytest.approx(path.state(emitted).position - MEASUREMENT.position, abs=0.1)


def test_without_travel_time_it_is_where_the_target_is() -> None:
    offset, delay = offset_seen(STATE[None, :4], MEASUREMENT.position, np.inf)
    assert delay[0] == 0.0
    assert offset[0] == pytest.approx(STATE[:2] - MEASUREMENT.position, abs=0.0)


def test_derivatives_are_those_of_the_innovation() -> None:
    """The travel time depends on the place, the Doppler factor on the speed of the source."""
    rows = linearise(STATE[None], MEASUREMENT, KNOWN, np.array([0.7]))
    for index, step in enumerate([1.0, 1.0, 1e-2, 1e-2, 1e-2]):
        moved = np.tile(STATE, (2, 1))
        moved[0, index] += step
        moved[1, index] -= step
        change = linearise(moved, MEASUREMENT, KNOWN, np.array([0.7])).innovation
        numerical = -(change[0] - change[1]) / (2.0 * step)
        largest = np.abs(rows.derivative[0]).max(axis=-1)
        error = np.abs(rows.derivative[0, [0, 2], index] - numerical[[0, 2]])
        assert np.all(error < 3e-5 * largest[[0, 2]])


def test_the_first_azimuth_says_nothing_of_the_velocity() -> None:
    """Seen where it was, and carried on since: 5 km away by 3.3 s, 38 m across for 11.5 m/s."""
    bank = start_bank(replace(MEASUREMENT, frequency=np.zeros(0)), np.array([4900.0, 5100.0]), 20.0)
    (covariance,) = bank.covariance
    across = np.array([-np.sin(0.7), np.cos(0.7)])
    place, carried, velocity = (
        across @ covariance[rows, columns] @ across
        for rows, columns in (
            (slice(2), slice(2)),
            (slice(2), slice(2, 4)),
            (slice(2, 4), slice(2, 4)),
        )
    )
    delay = 5000.0 / 1500.0
    seen = place - 2.0 * delay * carried + delay**2 * velocity
    assert np.sqrt(velocity) == pytest.approx(20.0 / np.sqrt(3.0))
    assert np.sqrt(seen) == pytest.approx(5000.0 * 0.01)
    assert place - carried**2 / velocity == pytest.approx(seen)


def rms(errors: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(errors))))


@pytest.mark.slow
def test_a_fast_target_is_reported_where_it_is() -> None:
    """12 m/s at 4 to 6 km: the sound is up to 50 m behind the target; four seeds."""
    fast = replace(
        NEAR,
        motion=KinematicMotion(position=(5000.0, 2000.0), course_deg=350.0, speed=12.0),
    )
    exact = replace(
        DIRECTIONS, angle_standard_deviation_deg=0.05, frequency_standard_deviation=0.01
    )
    runs = [simulated(scene(exact, targets=(fast,), seed=seed)) for seed in (5, 1, 4, 6)]
    frames = [[frame for frame, _ in run] for run in runs]
    errors: dict[bool, list[float]] = {}
    squared = []
    for travel_time in (True, False):
        told = TmaTrackerConfiguration(travel_time=travel_time)
        updates = fed_together([TmaTrackerStage(told) for _ in runs], frames)
        lists = [listed(own[-1]) for own in updates]
        errors[travel_time] = [
            error_of(tracks, run[-1][1]) for tracks, run in zip(lists, runs, strict=True)
        ]
        if travel_time:
            squared = [
                error**2 / np.trace(tracks.covariance[0, :2, :2])
                for tracks, error in zip(lists, errors[True], strict=True)
            ]
    assert errors[True][0] < 15.0
    assert rms(errors[True]) < 0.75 * rms(errors[False])
    assert min(errors[False]) > 30.0
    assert np.mean(squared) < 1.5
