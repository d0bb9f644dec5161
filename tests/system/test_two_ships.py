"""Two ships in company, live: the consort's bearings in its namespace, one picture of both."""

from __future__ import annotations

from pathlib import Path

import pytest

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from tests.system.command_line import report_of, run_command


@pytest.mark.slow
def test_bearings_of_the_consort_are_fused_with_those_of_own_ship(tmp_path: Path) -> None:
    bag, report = tmp_path / "bag", tmp_path / "run.json"
    done = run_command(
        tmp_path,
        *("run", "two_ships", "--duration", "60", "--rate", "max"),
        *("--record", bag, "--json", report),
    )
    assert done.returncode == 0, done.stdout
    live = report_of(report)
    assert live["topics"]["/consort/passive/bearing_tracks"]["messages"] == 30
    assert live["latency_ms"]["fused_count"] > 0
    *_, last = position_tracks_of(read_bag(bag), "/tracks")
    assert {"array", "consort_array"} <= set(last.contributor_sensor)
