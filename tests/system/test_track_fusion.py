"""Sonar, array, moored station and fusion in one run: recorded, replayed, offline, all the same."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_fusion_chain import run_offline_fusion_chain
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.system.command_line import digests, report_of, run_command

SCENARIO = """
name: fused
duration: 80.0
active_sonar: {ping_interval: 10.0, maximum_range: 7000.0}
own_ship:
  speed: 5.0
  turns: [{time: 50.0, course_deg: 90.0, rate_deg: 2.0}]
bearing_sensors:
  - {sensor_id: array, angle_kind: cone, frame_interval: 2.0, misalignment_deg: 1.0}
  - sensor_id: buoy
    namespace: buoy
    platform: fixed
    position: [4000.0, 0.0]
    angle_kind: azimuth
    frame_interval: 5.0
targets:
  - name: freighter
    motion: {kind: kinematic, position: [-3000.0, 3000.0], course_deg: 80, speed: 6}
  - {name: ferry, motion: {kind: kinematic, position: [1000.0, 4500.0], course_deg: 200, speed: 5}}
nodes: {hpda_tracker: {}, tma_tracker: {}, track_fusion: {}}
"""


PLACES = """
name: places
duration: 24.0
own_ship: {speed: 5.0}
array: {n_elements: 10, snapshot_rate: 40.0}
stations:
  - namespace: pier
    platform: fixed
    position: [1500.0, 0.0]
    array: {n_elements: 8, snapshot_rate: 20.0, misalignment_deg: 1.0}
    active_sonar:
      ping_interval: 5.0
      maximum_range: 3500.0
      signal_to_noise_ratio_db: 15.0
      false_alarm_probability: 0.0001
targets:
  - name: freighter
    motion: {kind: kinematic, position: [-500.0, 2000.0], course_deg: 80, speed: 6}
nodes: {tma_tracker: {}, track_fusion: {}}
"""


def assert_same(recorded: Path, expected: Sequence[PositionTracks]) -> None:
    """Assert that the fused tracks of a bag are those given, to the last bit."""
    lists = list(position_tracks_of(read_bag(recorded), "/tracks"))
    for found, told in zip(lists, expected, strict=True):
        assert (found.stamp, found.next_stamp) == (told.stamp, told.next_stamp)
        assert found.contributor_sensor == told.contributor_sensor
        for name in ("id", "state", "covariance"):
            assert np.array_equal(getattr(found, name), getattr(told, name), equal_nan=True)


@pytest.mark.slow
def test_arrays_and_sonars_of_stations_are_the_same_offline(tmp_path: Path) -> None:
    scene, bag = tmp_path / "places.yaml", tmp_path / "bag"
    scene.write_text(PLACES, encoding="utf-8")
    done = run_command(tmp_path, "run", scene, "--rate", "max", "--record", bag)
    assert done.returncode == 0, done.stdout
    _, updates = run_offline_fusion_chain(load_scenario(scene))
    assert_same(bag, [one.tracks for one in updates])
    heard = {name for one in updates for name in one.tracks.contributor_sensor}
    assert {"pier/active/tracks", "array", "pier_array"} <= heard


@pytest.mark.slow
def test_a_sea_of_several_sensors_becomes_one_list(tmp_path: Path) -> None:
    scene, bag = tmp_path / "fused.yaml", tmp_path / "bag"
    scene.write_text(SCENARIO, encoding="utf-8")
    done = run_command(
        tmp_path, "run", scene, "--rate", "max", "--record", bag, "--json", tmp_path / "run.json"
    )
    assert done.returncode == 0, done.stdout
    live = report_of(tmp_path / "run.json")
    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", tmp_path / "replay.json")
    assert done.returncode == 0, done.stdout
    replayed = report_of(tmp_path / "replay.json")
    for topic in ("/tracks", "/passive/alignment"):
        assert replayed["comparison"][topic].startswith("identical: ")
        assert digests(replayed)[topic] == digests(live)[topic]

    moments, updates = run_offline_fusion_chain(load_scenario(scene))
    assert_same(bag, [one.tracks for one in updates])

    score = live["score"]["positions"]["/tracks"]
    assert score["targets_never_held"] == 0 and score["false_tracks"] == 0
    known = updates[-1].alignments
    turned = np.degrees(known.misalignment[known.sensor_id.index("array")])
    assert abs(turned - 1.0) < 0.7
    assert moments[-1].frame.stamp == updates[-1].tracks.stamp
