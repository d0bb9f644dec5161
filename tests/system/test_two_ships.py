"""Two ships in company, live: each has its picture, and takes what the other one has found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_fusion_chain import run_offline_fusion_chain
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.system.changed_scenarios import changed_scenario
from tests.system.command_line import report_of, run_command

SOONER = {
    "duration: 600.0": "duration: 90.0",
    "time: 200.0": "time: 60.0",
    "time: 300.0": "time: 75.0",
    "[-3500.0, 2500.0]": "[-300.0, 2500.0]",
    "[8000.0, 2500.0]": "[6000.0, 2500.0]",
}
"""Of the scenario: ships turn, and the far target of each comes into reach, within 80 s."""


def made_of(tracks: PositionTracks, row: int) -> set[str]:
    """Return the sensors and lists that a row is made of."""
    sensors = np.array(tracks.contributor_sensor)
    return set(sensors[tracks.contributor_track == row].tolist())


@pytest.mark.slow
def test_two_ships_exchange_what_they_have_found_and_a_replay_does_the_same(tmp_path: Path) -> None:
    bag, report, again = tmp_path / "bag", tmp_path / "run.json", tmp_path / "again.json"
    scene = changed_scenario(tmp_path, "ships_in_company", SOONER)
    done = run_command(
        tmp_path,
        *("run", scene, "--rate", "max", "--record", bag, "--json", report),
    )
    assert done.returncode == 0, done.stdout
    live = report_of(report)
    assert live["topics"]["/consort/passive/bearing_tracks"]["messages"] == 45
    assert live["topics"]["/consort/own_ship/odometry"]["messages"] >= 45
    assert live["latency_ms"]["fused_count"] > 0
    recording = read_bag(bag)
    lists = {
        name: list(position_tracks_of(recording, name)) for name in ("/tracks", "/consort/tracks")
    }
    own, other = (one[29] for one in lists.values())
    assert {"consort/own_tracks", "active/tracks", "array"} <= set(own.contributor_sensor)
    assert {"own_tracks", "consort/active/tracks"} <= set(other.contributor_sensor)
    # One ship is out of the reach of each sonar, so that it is in the picture by the other one.
    assert len(own.id[own.established]) == len(other.id[other.established]) == 3
    assert {int(one) >> 48 for one in own.id} == {1}
    assert {int(one) >> 48 for one in other.id} == {2}
    for tracks in lists.values():
        found = [made_of(tracks[-1], row) for row in range(len(tracks[-1]))]
        assert all({"active/tracks", "consort/active/tracks"} <= one for one in found)
        # What the other ship found first keeps its name when own sensors find it, too.
        assert len({int(name) for one in tracks for name in one.id[one.established]}) == 3

    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", again)
    assert done.returncode == 0, done.stdout
    compared = report_of(again)["comparison"]
    for topic in ("/tracks", "/own_tracks", "/consort/tracks", "/consort/own_tracks"):
        assert compared[topic] == "identical: 45 messages"

    # What each ship makes of both does not depend on when the other one's lists have come.
    scenario = load_scenario(scene)
    for place, name in (("", "/tracks"), ("consort", "/consort/tracks")):
        _, updates = run_offline_fusion_chain(scenario, place)
        for told, one in zip(lists[name], updates, strict=True):
            assert np.array_equal(told.id, one.tracks.id)
            assert np.array_equal(told.state, one.tracks.state, equal_nan=True)
            assert np.array_equal(told.covariance, one.tracks.covariance, equal_nan=True)
