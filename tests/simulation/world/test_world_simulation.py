"""Own ship and truth are told at every instant a sensor needs them, each once, and are the same."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
)
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation
from sonar_tracking.simulation.sensors.sample_simulation import SampleSimulation
from sonar_tracking.simulation.world.world_simulation import WorldInstant, WorldSimulation

SENSORS = {
    "array": {"n_elements": 4, "snapshot_rate": 10.0, "block_snapshots": 20},
    "active_sonar": {"ping_interval": 5.0, "maximum_range": 3000.0},
    "bearing_sensors": [
        {"sensor_id": "buoy", "namespace": "buoy", "platform": "fixed", "frame_interval": 3.0}
    ],
}
WORLD = {
    "duration": 9.5,
    "own_ship": {"speed": 4.0, "turns": [{"time": 5.0, "course_deg": 90.0}]},
    "targets": [{"motion": {"kind": "kinematic", "position": [900.0, 500.0], "speed": 3.0}}],
}


def instants(scenario: Scenario) -> list[WorldInstant]:
    return list(iter(WorldSimulation(scenario).next_instant, None))


def seconds(scenario: Scenario, stamps: Iterable[int]) -> list[float]:
    return [(stamp - scenario.epoch) / NANOSECONDS for stamp in stamps]


@pytest.mark.parametrize(
    ("sensors", "own_ship", "truth"),
    [
        # Blocks of 2 s, the last one of 1.5 s.
        (["array"], [0, 2, 4, 6, 8, 9.5], [0, 2, 4, 6, 8]),
        # The echoes of a ping are in after 4 s.
        (["active_sonar"], [0, 4, 5, 9], [0, 5]),
        (["bearing_sensors"], [0, 3, 6, 9], [0, 3, 6, 9]),
        (["array", "active_sonar"], [0, 2, 4, 5, 6, 8, 9, 9.5], [0, 2, 4, 5, 6, 8]),
        (list(SENSORS), [0, 2, 3, 4, 5, 6, 8, 9, 9.5], [0, 2, 3, 4, 5, 6, 8, 9]),
    ],
)
def test_each_instant_that_a_sensor_needs_is_told_once(
    sensors: list[str], own_ship: list[float], truth: list[float]
) -> None:
    scenario = scenario_from_mapping({**WORLD, **{each: SENSORS[each] for each in sensors}}, "test")
    told = instants(scenario)
    stamps = [each.stamp for each in told]
    assert stamps == sorted(set(stamps))
    states = [each.own_ship for each in told if each.own_ship is not None]
    pictures = [each.truth_tracks for each in told if each.truth_tracks is not None]
    assert seconds(scenario, (state.stamp for state in states)) == own_ship
    assert seconds(scenario, (picture.stamp for picture in pictures)) == truth
    following = [picture.next_stamp for picture in pictures]
    assert following == [*(picture.stamp for picture in pictures[1:]), END_OF_DATA]


def data_of(scenario: Scenario) -> tuple[list[OwnShipState], list[TruthTracks]]:
    """Return own ship and truth as the one sensor of a scenario has them beside its data."""
    if scenario.hydrophones is not None:
        data: list = list(iter(SampleSimulation(scenario).next_block, None))
    elif scenario.array_given:
        data = list(iter(ArraySimulation(scenario).next_block, None))
    elif scenario.active_sonar is not None:
        data = list(ActiveSonarSimulation(scenario))
    else:
        data = list(iter(BearingSimulation(scenario).next_frame, None))
    states = [np.atleast_1d(np.array(each.own_ship, dtype=object)) for each in data]
    return [state for each in states for state in each], [each.truth_tracks for each in data]


@pytest.mark.parametrize(
    "name",
    [
        *("active", "crossing_targets", "tonals"),
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("cross_fix", "tma")),
    ],
)
def test_the_world_is_that_of_the_data_bit_for_bit(name: str) -> None:
    scenario = load_scenario(name)
    if scenario.array_given:
        scenario = replace(scenario, duration=3.3)
    states, pictures = data_of(scenario)
    told = instants(scenario)
    assert [each.own_ship for each in told if each.own_ship is not None] == states
    found = [each.truth_tracks for each in told if each.truth_tracks is not None]
    assert len(found) == len(pictures)
    for picture, expected in zip(found, pictures, strict=True):
        assert (picture.stamp, picture.next_stamp) == (expected.stamp, expected.next_stamp)
        np.testing.assert_array_equal(picture.id, expected.id)
        np.testing.assert_array_equal(picture.position, expected.position)
        np.testing.assert_array_equal(picture.velocity, expected.velocity)


def test_no_two_sensors_share_their_random_numbers() -> None:
    """A station beside an array has streams of its own, and none of it changes the others' data."""
    one = scenario_from_mapping({**WORLD, "array": SENSORS["array"]}, "test")
    all_of_them = scenario_from_mapping({**WORLD, **SENSORS}, "test")
    alone, beside = (ArraySimulation(each).next_block() for each in (one, all_of_them))
    assert alone is not None and beside is not None
    np.testing.assert_array_equal(alone.snapshots.data, beside.snapshots.data)
    station = scenario_from_mapping(
        {**WORLD, "bearing_sensors": SENSORS["bearing_sensors"]}, "test"
    )
    frames = [BearingSimulation(each).next_frame() for each in (station, all_of_them)]
    errors = [
        report.bearings.measurement - report.truth.arrival_angle
        for frame in frames
        if frame is not None
        for report in frame.reports
        if report.bearings is not None
    ]
    assert errors[0] != errors[1]
