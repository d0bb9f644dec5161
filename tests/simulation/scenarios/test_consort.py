"""Protects the second ship: what it carries is where it is, and nothing is carried by none."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.offline.offline_fusion_chain import run_offline_fusion_chain
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
    scenario_to_mapping,
)
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation

SEA: dict[str, Any] = {
    "duration": 30.0,
    "consort": {"position": [1000.0, 0.0], "course_deg": 90.0, "speed": 5.0},
    "active_sonar": {"platform": "consort", "ping_interval": 10.0, "sound_speed": 1500.0},
    "bearing_sensors": [{"sensor_id": "other", "platform": "consort", "frame_interval": 10.0}],
    "targets": [{"motion": {"kind": "kinematic", "position": [1000.0, 2000.0]}}],
}


def test_sensors_of_the_consort_move_with_it() -> None:
    scenario = scenario_from_mapping(SEA, "sea")
    simulation, places = BearingSimulation(scenario), []
    while (frame := simulation.next_frame()) is not None:
        places += [report.truth.sensor.position[:2] for report in frame.reports]
    assert np.allclose(places, [(1000.0, 0.0), (1050.0, 0.0), (1100.0, 0.0)])
    pings = [ping.contacts.sensor_position for ping in ActiveSonarSimulation(scenario)]
    assert np.allclose(pings, places)


def test_a_scenario_with_a_consort_reads_back_as_the_same() -> None:
    scenario = scenario_from_mapping(SEA, "sea")
    assert scenario_from_mapping(scenario_to_mapping(scenario), "again") == scenario


@pytest.mark.parametrize("section", ["active_sonar", "bearing_sensors"])
def test_a_platform_that_is_not_there_is_named(section: str) -> None:
    alone = {name: SEA[name] for name in ("duration", section, "targets")}
    with pytest.raises(ConfigurationError, match=rf"{section}.*consort"):
        scenario_from_mapping(alone, "sea")


@pytest.mark.slow
def test_two_ships_make_one_picture_though_an_array_is_turned() -> None:
    scenario = replace(load_scenario("two_ships"), duration=180.0)
    _, updates = run_offline_fusion_chain(scenario)
    known, tracks = updates[-1].alignments, updates[-1].tracks
    place = known.sensor_id.index("consort_array")
    assert abs(np.degrees(known.misalignment[place]) - 1.0) < 0.4
    for row in np.flatnonzero(tracks.established)[:2]:
        own = np.flatnonzero(tracks.contributor_track == row)
        sensors = {tracks.contributor_sensor[one] for one in own}
        assert sensors == {"active/tracks", "array", "consort_array"}
