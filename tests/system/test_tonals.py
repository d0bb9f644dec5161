"""``sonar-tracking run tonals``: from element time series on, live, replayed and offline agree."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from sonar_tracking.bags.storage.bag_records import (
    bearing_tracks_of,
    frequency_lines_of,
    lofar_rows_of,
)
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_sample_chain import run_offline_sample_chain
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.system.command_line import digests, report_of, run_command

SECONDS = 22.0
"""Five of them with lines that are there to stay."""
OUTPUTS = (
    "/array/snapshots",
    "/array/subspaces",
    "/passive/bearing_tracks",
    "/passive/frequency_lines",
    "/array/lofar",
    "/passive/tracks",
)


def test_the_chain_from_samples_runs_and_replays_identically(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    done = run_command(
        tmp_path, "run", "tonals", "--duration", str(SECONDS), "--rate", "max", "--record", bag,
        "--json", tmp_path / "run.json",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    live = report_of(tmp_path / "run.json")
    assert live["topics"]["/passive/frequency_lines"]["messages"] == 22
    assert live["topics"]["/array/lofar"]["messages"] == 21

    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", tmp_path / "replay.json")
    assert done.returncode == 0, done.stdout
    replayed = report_of(tmp_path / "replay.json")
    assert all(replayed["comparison"][name].startswith("identical: ") for name in OUTPUTS)
    assert digests(replayed) == {name: digests(live)[name] for name in digests(replayed)}

    offline = run_offline_sample_chain(replace(load_scenario("tonals"), duration=SECONDS))
    recording = read_bag(bag)
    bearings = list(bearing_tracks_of(recording, "/passive/bearing_tracks"))
    for picture, expected in zip(bearings, offline.bearings, strict=True):
        np.testing.assert_array_equal(picture.arrival_angle, expected.arrival_angle)
        assert picture.sensor == expected.sensor
    lines = list(frequency_lines_of(recording, "/passive/frequency_lines"))
    for heard, other in zip(lines, offline.lines, strict=True):
        assert (heard.stamp, heard.next_stamp) == (other.stamp, other.next_stamp)
        np.testing.assert_array_equal(heard.frequency, other.frequency)
        np.testing.assert_array_equal(heard.line_id, other.line_id)
    rows = list(lofar_rows_of(recording, "/array/lofar"))
    for row, made in zip(rows, offline.rows, strict=True):
        np.testing.assert_array_equal(row.level_db, made.level_db)
    assert len(lines[-2].line_id) == 3
