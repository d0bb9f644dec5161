"""Sensors of every kind in one world: what runs at once is what each chain gives by itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sonar_tracking.bags.storage.bag_records import directions_of, position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_bearing_chain import run_offline_chain
from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation
from tests.system.command_line import digests, report_of, run_command

SCENARIO = """
duration: 14.0
own_ship: {speed: 4.0, turns: [{time: 6.0, course_deg: 30.0, rate_deg: 1.0}]}
array: {n_elements: 12, spacing: 0.0625, center_frequency: 12000.0, bandwidth: 100.0,
        snapshot_rate: 100.0, block_snapshots: 50}
active_sonar: {ping_interval: 5.0, maximum_range: 3000.0, signal_to_noise_ratio_db: 16.0}
bearing_sensors:
  - {sensor_id: pier, namespace: pier, platform: fixed, position: [2000.0, 0.0],
     angle_kind: azimuth, frame_interval: 4.0}
targets:
  - name: ferry
    motion: {kind: kinematic, position: [1500.0, 900.0], course_deg: 300.0, speed: 6.0}
  - name: tug
    echoes: false
    motion: {kind: kinematic, position: [1200.0, -500.0], course_deg: 10.0, speed: 4.0}
  - name: wharf
    heard: false
    motion: {kind: kinematic, position: [-900.0, 700.0]}
nodes:
  tma_tracker: {}
"""
BEARINGS, STATION = "/passive/bearing_tracks", "/pier/passive/bearing_tracks"
TRACKS, TRUTH = "/active/tracks", "/truth/tracks"


def test_all_chains_at_once_give_what_each_gives_by_itself(tmp_path: Path) -> None:
    path, bag = tmp_path / "shared.yaml", tmp_path / "bag"
    path.write_text(SCENARIO)
    done = run_command(
        tmp_path, "run", path, "--rate", "max", "--record", bag, "--json", tmp_path / "run.json"
    )
    assert done.returncode == 0, done.stdout
    live = report_of(tmp_path / "run.json")
    # Blocks of 0.5 s and pings of 4 s every 5 s: all their instants are ends of blocks.
    assert live["topics"]["/own_ship/odometry"]["messages"] == 29
    assert live["topics"][TRUTH]["messages"] == 28
    assert live["nodes"]["world_simulator"]["messages_out"] == 57

    scenario, recorded = load_scenario(path), read_bag(bag)
    active = run_offline_active_chain(scenario)
    for found, update in zip(position_tracks_of(recorded, TRACKS), active.updates, strict=True):
        assert found.stamp == update.tracks.stamp
        assert np.array_equal(found.id, update.tracks.id)
        assert np.array_equal(found.state, update.tracks.state)
    passive = run_offline_chain(scenario)
    for heard, tracks in zip(directions_of(recorded, BEARINGS), passive.tracks, strict=True):
        assert heard.stamp == tracks.stamp
        assert np.array_equal(heard.id, tracks.id)
        assert np.array_equal(heard.arrival_angle, tracks.arrival_angle)
    reports = [
        report.bearings
        for frame in iter(BearingSimulation(scenario).next_frame, None)
        for report in frame.reports
    ]
    measured = filter(None, reports)
    for heard, bearings in zip(directions_of(recorded, STATION), measured, strict=True):
        assert heard.stamp == bearings.stamp
        assert np.array_equal(heard.measurement, bearings.measurement)
        assert len(heard.id) == 2, "the wharf makes no sound"

    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", tmp_path / "replay.json")
    assert done.returncode == 0, done.stdout
    replayed = report_of(tmp_path / "replay.json")
    assert digests(replayed) == {name: digests(live)[name] for name in digests(replayed)}
    assert {TRACKS, BEARINGS, "/passive/tracks"} <= set(replayed["comparison"])
