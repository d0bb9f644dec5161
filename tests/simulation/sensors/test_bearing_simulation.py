"""Protects what simulated stations report: geometry, Doppler, schedules, errors, identities."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import emission_times, wrap_angle
from sonar_tracking.records.bearings import AngleKind, BearingTracks, TrackStatus
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
    check_bearing_sensors,
)
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import (
    OwnShipConfiguration,
    Receiver,
    TurnConfiguration,
)
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    scenario_from_mapping,
    scenario_to_mapping,
)
from sonar_tracking.simulation.scenarios.target import LineConfiguration, TargetConfiguration
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation

EPOCH = 1_767_225_600 * 10**9
EXACT = BearingSensorConfiguration(
    angle_standard_deviation_deg=1e-9, frequency_standard_deviation=1e-9
)
TARGET = TargetConfiguration(
    lines=(LineConfiguration(frequency=300.0), LineConfiguration(210.0, present=(5.0, 10.0))),
    motion=KinematicMotion(position=(4000.0, 3000.0), course_deg=270.0, speed=3.0),
)


def scene(*sensors: BearingSensorConfiguration, **changes: Any) -> Scenario:
    made = Scenario(
        array_given=False,
        bearing_sensors=sensors or (EXACT,),
        own_ship=OwnShipConfiguration(course_deg=90.0, speed=6.0),
        targets=(TARGET,),
        start=0.0,
        duration=20.0,
        seed=3,
        epoch=EPOCH,
    )
    return replace(made, **changes)


def measured(
    world: Scenario, station: int = 0
) -> list[tuple[BearingTracks, FrequencyLines, BearingTracks]]:
    simulation = BearingSimulation(world)
    found = []
    while (frame := simulation.next_frame()) is not None:
        for report in frame.reports:
            if report.station == station and report.bearings is not None:
                assert report.lines is not None
                found.append((report.bearings, report.lines, report.truth))
    return found


def test_the_paper_s_model_without_travel_time() -> None:
    paper = replace(EXACT, propagation="instantaneous", angle_kind="azimuth")
    for index, (bearings, lines, _) in enumerate(measured(scene(paper))):
        offset = np.array([4000.0 - 3.0 * index, 3000.0]) - [6.0 * index, 0.0]
        relative = np.array([-9.0, 0.0])
        assert bearings.angle_kind is AngleKind.AZIMUTH
        azimuth = np.arctan2(offset[1], offset[0])
        assert bearings.measurement == pytest.approx([azimuth], abs=1e-9)
        rate = offset @ relative / np.hypot(*offset)
        assert lines.frequency[0] == pytest.approx(300.0 * (1.0 - rate / 1500.0), abs=1e-6)


def test_doppler_is_the_rate_of_the_emission_time() -> None:
    motion, step = TARGET.motion, 1e-3
    assert isinstance(motion, KinematicMotion)
    _, lines, _ = measured(scene())[10]
    times = 10.0 + np.array([-step, step])
    place = np.stack([6.0 * times, 0.0 * times], axis=-1)
    emitted = emission_times(motion.trajectory, place, times, 1500.0)
    ratio = (emitted[1] - emitted[0]) / (2.0 * step)
    assert lines.frequency[0] == pytest.approx(300.0 * ratio, abs=1e-5)


def test_a_line_array_sees_a_cone_from_its_own_axis() -> None:
    heading = OwnShipConfiguration(course_deg=0.0, speed=0.0)
    sides = []
    for x in (-1000.0, 1000.0):
        target = replace(TARGET, motion=KinematicMotion(position=(x, 1000.0)))
        world = scene(replace(EXACT, mounting_yaw_deg=180.0), own_ship=heading, targets=(target,))
        bearings, _, truth = measured(world)[0]
        assert bearings.ambiguous.all()
        sides.append(bearings.measurement[0])
        assert truth.arrival_angle == pytest.approx(bearings.measurement, abs=1e-8)
    assert sides == pytest.approx([-np.pi / 4.0] * 2, abs=1e-8)


def test_lines_follow_their_schedule_and_keep_their_identity() -> None:
    heard = [list(lines.line_id) for _, lines, _ in measured(scene())]
    assert heard == [[1]] * 5 + [[1, 2]] * 5 + [[1]] * 10


def test_a_target_that_comes_back_is_a_new_track() -> None:
    world = scene(targets=(replace(TARGET, present=(0.0, 5.0, 10.0, 20.0)),))
    rows = [[*zip(b.id, b.status, strict=True)] for b, _, _ in measured(world)]
    running, ended = TrackStatus.CONFIRMED, TrackStatus.TERMINATED
    assert rows == [[(1, running)]] * 5 + [[(1, ended)]] + [[]] * 4 + [[(2, running)]] * 10
    assert [lines.track_id[0] for _, lines, _ in measured(world)[10:]] == [2] * 10


@pytest.mark.slow
def test_errors_are_as_large_as_stated() -> None:
    station = BearingSensorConfiguration(angle_kind="azimuth", outlier_share=0.05)
    frames = measured(scene(station, duration=1500.0))
    error = np.array([wrap_angle(b.measurement - t.arrival_angle)[0] for b, _, t in frames])
    wild = np.abs(error) > 6.0 * station.angle_deviation
    assert np.mean(wild) == pytest.approx(0.05, abs=0.017)
    assert np.std(error[~wild]) == pytest.approx(station.angle_deviation, rel=0.08)
    assert frames[0][0].measurement_variance == pytest.approx(station.angle_deviation**2)
    quiet = measured(scene(replace(station, frequency_standard_deviation=1e-9), duration=1500.0))
    pairs = zip(frames, quiet, strict=True)
    noise = [a.frequency[0] - b.frequency[0] for (_, a, _), (_, b, _) in pairs]
    assert np.std(noise) == pytest.approx(0.1, rel=0.08)


@pytest.mark.slow
def test_frames_are_missing_but_the_end_is_told() -> None:
    frames = measured(scene(replace(EXACT, missing_share=0.3), duration=1000.0))
    assert 620 < len(frames) < 780
    assert frames[-1][0].next_stamp == frames[-1][1].next_stamp == END_OF_DATA


def test_stations_run_at_their_own_pace_and_draw_their_own_numbers() -> None:
    first = BearingSensorConfiguration(frame_interval=1.0)
    second = BearingSensorConfiguration(
        sensor_id="buoy",
        namespace="buoy",
        platform="fixed",
        frame_interval=2.5,
        position=(0.0, 9e3),
    )
    world = scene(first, second)
    simulation, stamps, reports = BearingSimulation(world), [], []
    while (frame := simulation.next_frame()) is not None:
        stamps.append(frame.start_stamp)
        assert frame.start_stamp < frame.due_stamp
        reports += [report.station for report in frame.reports]
        assert frame.own_ship.stamp == frame.truth_tracks.stamp == frame.start_stamp
    assert stamps == sorted(set(stamps))
    assert frame is None and reports.count(0) == 20 and reports.count(1) == 8
    alone = measured(scene(first))
    beside = measured(world)
    for (one, _, _), (other, _, _) in zip(alone, beside, strict=True):
        assert one.measurement.tolist() == other.measurement.tolist()
    assert measured(world, 1)[0][0].sensor.position == (0.0, 9e3, 0.0)


def test_frames_looked_ahead_have_the_angles_of_each_by_itself() -> None:
    buoy = replace(EXACT, sensor_id="buoy", platform="fixed", angle_kind="azimuth")
    motion = KinematicMotion(position=(900.0, -400.0), speed=4.0, acceleration=0.05)
    turns = (TurnConfiguration(50.0, 0.0, 1.0), TurnConfiguration(170.0, 200.0, 2.0))
    world = scene(
        *(EXACT, replace(buoy, namespace="buoy")),
        own_ship=OwnShipConfiguration(course_deg=90.0, speed=6.0, turns=turns),
        targets=(TARGET, replace(TARGET, motion=motion)),
        duration=300.0,
    )
    for station, sensor in enumerate(world.bearing_sensors):
        receiver = Receiver(
            sensor.trajectory(world.platforms),
            sensor.mounting_yaw,
            sensor.sound_speed,
            sensor.ambiguous,
        )
        for frame, (_, _, truth) in enumerate(measured(world, station)):
            now = np.array([frame * sensor.frame_interval])
            alone = [target.motion.arrival(now, receiver) for target in world.targets]
            angle, rate = np.array(alone)[..., 0].T
            if not sensor.ambiguous:
                ship = receiver.trajectory.state(now[0])
                angle = wrap_angle(ship.azimuth + sensor.mounting_yaw + 0.5 * np.pi - angle)
                rate = ship.turn_rate - rate
            assert truth.arrival_angle.tolist() == angle.tolist()
            assert truth.arrival_angle_rate.tolist() == rate.tolist()


def test_reports_without_the_world_are_those_of_the_frames() -> None:
    world = scene(EXACT, replace(EXACT, sensor_id="buoy", namespace="buoy", frame_interval=2.5))
    simulation = BearingSimulation(world)
    for frame in iter(BearingSimulation(world).next_frame, None):
        reports = simulation.next_reports()
        assert [one.station for one in reports] == [one.station for one in frame.reports]
        assert [one.truth.stamp for one in reports] == [frame.start_stamp] * len(reports)
    assert simulation.next_reports() == ()


def test_lines_may_be_left_without_a_track() -> None:
    station = replace(EXACT, attribute_lines=False)
    bearings, lines, _ = measured(scene(station))[0]
    assert lines.track_id.tolist() == [0]
    assert lines.arrival_angle == pytest.approx(bearings.measurement, abs=1e-7)


def test_a_wandering_target_has_the_stated_acceleration_and_is_the_same_again() -> None:
    motion = KinematicMotion(position=(0.0, 0.0), speed=3.0, acceleration=0.01)
    times = np.arange(0.0, 3000.0)
    states = motion.trajectory.state(times)
    change = np.diff(states.velocity, axis=0)
    assert np.std(change) == pytest.approx(0.01, rel=0.05)
    moved = np.diff(states.position, axis=0)
    mean = 0.5 * (states.velocity[1:] + states.velocity[:-1])
    assert moved == pytest.approx(mean, abs=1e-8)
    again = KinematicMotion(position=(0.0, 0.0), speed=3.0, acceleration=0.01)
    assert again.trajectory.state(1234.5).position == pytest.approx(
        motion.trajectory.state(1234.5).position, abs=0.0
    )
    instants = np.array([-3.0, 0.0, 7.0, 1023.9, 1234.5])
    together = motion.trajectory.state(instants)
    for place, instant in enumerate(instants):
        alone = motion.trajectory.state(instant)
        assert alone.position.tolist() == together.position[place].tolist()
        assert alone.velocity.tolist() == together.velocity[place].tolist()


def test_instant_turns_of_own_ship_are_nearly_so() -> None:
    turning = OwnShipConfiguration(
        course_deg=90.0, speed=6.0, turns=(TurnConfiguration(100.0, 0.0, 360.0),)
    )
    state = turning.trajectory().state(200.0)
    assert state.position == pytest.approx([600.0, 600.0], abs=1.0)


@pytest.mark.parametrize(
    ("sensors", "part"),
    [
        ((EXACT, replace(EXACT, namespace="a")), "sensor_id"),
        ((EXACT, replace(EXACT, sensor_id="b")), "namespace"),
        ((replace(EXACT, namespace="2 b"),), "letters"),
        ((replace(EXACT, position=(1.0,)),), "position"),
    ],
)
def test_stations_that_cannot_be_told_apart_are_refused(
    sensors: tuple[BearingSensorConfiguration, ...], part: str
) -> None:
    with pytest.raises(ConfigurationError, match=part):
        check_bearing_sensors(sensors, "bearing_sensors")


def test_stations_and_lines_survive_a_recording() -> None:
    world = scene(EXACT, replace(EXACT, sensor_id="buoy", namespace="buoy"))
    again = scenario_from_mapping(scenario_to_mapping(world), "bag")
    assert again.bearing_sensors == world.bearing_sensors
    assert [target.lines for target in again.targets] == [target.lines for target in world.targets]
    assert again.sensors == ("bearing_sensors",)
    assert again.namespaces == {"bearing_sensors": ("", "buoy")}
    assert again.step == 1.0
