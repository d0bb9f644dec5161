"""Two ships in company, live: each has its picture, and takes what the other one has found."""

from __future__ import annotations

from pathlib import Path

import pytest

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from tests.system.command_line import report_of, run_command


@pytest.mark.slow
def test_two_ships_exchange_what_they_have_found_and_a_replay_does_the_same(tmp_path: Path) -> None:
    bag, report, again = tmp_path / "bag", tmp_path / "run.json", tmp_path / "again.json"
    done = run_command(
        tmp_path,
        *("run", "ships_in_company", "--duration", "60", "--rate", "max"),
        *("--record", bag, "--json", report),
    )
    assert done.returncode == 0, done.stdout
    live = report_of(report)
    assert live["topics"]["/consort/passive/bearing_tracks"]["messages"] == 30
    assert live["topics"]["/consort/own_ship/odometry"]["messages"] >= 30
    assert live["latency_ms"]["fused_count"] > 0
    *_, own = position_tracks_of(read_bag(bag), "/tracks")
    *_, other = position_tracks_of(read_bag(bag), "/consort/tracks")
    assert {"consort/own_tracks", "active/tracks", "array"} <= set(own.contributor_sensor)
    assert {"own_tracks", "consort/active/tracks"} <= set(other.contributor_sensor)
    # One ship is out of the reach of each sonar, so that it is in the picture by the other one.
    assert len(own.id[own.established]) == len(other.id[other.established]) == 3
    assert {int(one) >> 48 for one in own.id} == {1}
    assert {int(one) >> 48 for one in other.id} == {2}

    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", again)
    assert done.returncode == 0, done.stdout
    compared = report_of(again)["comparison"]
    for topic in ("/tracks", "/own_tracks", "/consort/tracks", "/consort/own_tracks"):
        assert compared[topic] == "identical: 30 messages"
