"""Protects stations: any number of arrays and sonars, each where it is said to be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    scenario_from_mapping,
    scenario_to_mapping,
)
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation
from sonar_tracking.simulation.sensors.sample_simulation import SampleSimulation
from sonar_tracking.simulation.world.world_simulation import WorldInstant, WorldSimulation

SONAR: dict[str, Any] = {"ping_interval": 10.0, "maximum_range": 3000.0}
SEA: dict[str, Any] = {
    "duration": 20.0,
    "own_ship": {"speed": 2.0},
    "consort": {"position": [1000.0, 0.0], "course_deg": 90.0, "speed": 5.0},
    "array": {"n_elements": 4, "snapshot_rate": 10.0},
    "stations": [
        {"namespace": "bow", "array": {"n_elements": 6, "snapshot_rate": 10.0}},
        {
            "namespace": "buoy",
            "platform": "fixed",
            "position": [-500.0, 200.0],
            "course_deg": 90.0,
            "array": {"n_elements": 4, "snapshot_rate": 4.0, "block_snapshots": 2},
        },
        {
            "namespace": "consort/tow",
            "platform": "consort",
            "array": {"n_elements": 3, "sensor_id": "tail"},
            "hydrophones": {"sample_rate": 1000.0, "block_samples": 500},
            "active_sonar": SONAR,
        },
    ],
    "targets": [{"motion": {"kind": "kinematic", "position": [300.0, 900.0]}}],
}


def sea(**changed: Any) -> Scenario:
    """Return the scenario with other sections."""
    return scenario_from_mapping({**SEA, **changed}, "sea")


def station(**changed: Any) -> Scenario:
    """Return a scenario with one station, some keys of which are others."""
    return sea(stations=[{"namespace": "bow", "array": {"n_elements": 4}, **changed}])


def test_a_scenario_with_stations_reads_back_as_the_same() -> None:
    assert scenario_from_mapping(scenario_to_mapping(sea()), "again") == sea()


def test_sensors_of_stations_have_names_of_their_own() -> None:
    arrays = [place.array.sensor_id for place in sea().places.values()]
    assert arrays == ["array", "bow_array", "buoy_array", "tail"]
    sonar = sea().of_station("consort/tow").active_sonar
    assert sonar is not None and sonar.sensor_id == "consort_tow_sonar"


def test_sensors_are_where_their_station_is() -> None:
    bow, buoy, tow = (sea().of_station(name) for name in ("bow", "buoy", "consort/tow"))
    for place, expected in ((bow, (0.0, 0.0)), (buoy, (-500.0, 200.0))):
        block = ArraySimulation(place).next_block()
        assert block is not None
        assert np.allclose(block.snapshots.sensor.position[:2], expected)
    samples = SampleSimulation(tow).next_block()
    assert samples is not None
    assert np.allclose(samples.samples.sensor.position[:2], (1000.0, 0.0))
    *_, ping = ActiveSonarSimulation(tow)
    assert np.allclose(ping.contacts.sensor_position, (1050.0, 0.0))
    # The target is north-east of the buoy, whose axis points to the east.
    assert block is not None
    angle = block.truth_bearings.arrival_angle[0]
    assert np.isclose(angle, 0.5 * np.pi - np.arctan2(700.0, 800.0), atol=1e-3)


def test_sensors_of_a_station_that_are_turned_do_not_tell_it() -> None:
    """An array hears as it stands, and says that it stands as it should; so does a sonar."""
    turned = {**SEA["stations"][2], "array": {"n_elements": 3, "misalignment_deg": 2.0}}
    turned["active_sonar"] = {**SONAR, "misalignment_deg": -3.0}
    scenes = [sea(), sea(stations=[*SEA["stations"][:2], turned])]
    true, off = (scene.of_station("consort/tow") for scene in scenes)
    heard, heard_off = (SampleSimulation(one).next_block() for one in (true, off))
    assert heard is not None and heard_off is not None
    assert np.array_equal(heard.samples.data, heard_off.samples.data)
    yaws = [
        2.0 * np.degrees(np.arctan2(one.samples.sensor.orientation[2], 1.0))
        for one in (heard, heard_off)
    ]
    assert np.isclose(yaws[0] - yaws[1], 2.0, atol=0.01)
    (told, _), (told_off, _) = (list(ActiveSonarSimulation(one)) for one in (true, off))
    assert len(told.contacts.azimuth) == len(told_off.contacts.azimuth) > 0
    apart = np.degrees(told_off.contacts.azimuth - told.contacts.azimuth)
    assert np.allclose((apart + 180.0) % 360.0 - 180.0, 3.0)


def test_no_two_arrays_hear_the_same_noise() -> None:
    alone, bow = ArraySimulation(sea()).next_block(), ArraySimulation(sea().of_station("bow"))
    heard = bow.next_block()
    assert alone is not None and heard is not None
    correlation = np.corrcoef(alone.snapshots.data.real[:, 0], heard.snapshots.data.real[:, 0])
    assert abs(correlation[0, 1]) < 0.9
    other_seed = {sea().of_station(name).seed for name in ("bow", "buoy", "consort/tow")}
    assert len(other_seed | {sea().seed}) == 4


def test_the_world_tells_both_ships_whenever_any_sensor_needs_them() -> None:
    world = WorldSimulation(sea())
    told: list[WorldInstant] = list(iter(world.next_instant, None))
    places = {round((one.stamp - sea().epoch) / 1e9, 3): one for one in told if one.own_ship}
    # Blocks of 2 s and 0.5 s, and the last echo of a ping, 4 s after it.
    assert {0.0, 0.5, 2.0, 4.0, 20.0} <= set(places)
    at = places[4.0]
    assert at.own_ship is not None and at.consort is not None
    assert np.allclose(at.own_ship.position, (0.0, 8.0))
    assert np.allclose(at.consort.position, (1020.0, 0.0))


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"namespace": ""}, r"stations\[0\] has no namespace"),
        ({"namespace": "bow wave"}, r"stations\[0\].namespace is 'bow wave'"),
        ({"array": None}, r"stations\[0\] has no sensor"),
        ({"array": {"n_elements": 1}}, r"stations\[0\].array has 1 elements"),
        ({"array": {"elements": 4}}, r"stations\[0\].array.elements"),
        ({"array": {"n_elements": 4, "sensor_id": "array"}}, "'array' like that of array"),
        ({"position": [1.0]}, r"stations\[0\].position has 1 entries"),
        ({"platform": "kite"}, "platform"),
        (
            {"array": None, "hydrophones": {}, "active_sonar": SONAR},
            r"stations\[0\] has hydrophones, but no array",
        ),
        (
            {"active_sonar": {**SONAR, "ping_interval": 1.0}},
            r"stations\[0\].active_sonar: Sound takes",
        ),
        ({"active_sonar": {**SONAR, "platform": "fixed"}}, "is where its station is"),
    ],
)
def test_a_station_that_cannot_be_is_named(changed: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        station(**changed)


def test_stations_have_names_that_differ_and_ships_that_exist() -> None:
    one = {"namespace": "a/b", "array": {"n_elements": 4}}
    with pytest.raises(ConfigurationError, match=r"'a_b' is taken by .*stations\[0\]"):
        sea(stations=[one, {**one, "namespace": "a_b"}])
    with pytest.raises(ConfigurationError, match=r"stations\[0\].platform is consort, but"):
        sea(consort=None, stations=[{**one, "platform": "consort"}])


def test_stations_alone_are_a_scenario() -> None:
    alone = {name: value for name, value in SEA.items() if name != "array"}
    scenario = scenario_from_mapping(alone, "sea")
    assert not scenario.array_given and scenario.sensors == ()
    assert (scenario.step, scenario.end) == (0.5, 20.0)
    assert scenario.simulated_in("consort/tow") == ("hydrophones", "active_sonar")
