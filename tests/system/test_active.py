"""``sonar-tracking run active``: recorded, replayed and computed offline, all is the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.system.command_line import digests, report_of, run_command
from tests.system.conftest import ACTIVE_DURATION, RecordedRun

TRACKS = "/active/tracks"
OUTPUTS = (TRACKS, "/active/threshold")
PINGS = 40


def test_the_active_scenario_runs_and_replays_identically(
    active_run: RecordedRun, tmp_path: Path
) -> None:
    bag, live = active_run.bag, active_run.report
    assert "warning" not in active_run.output
    assert live["nodes"]["contact_simulator"]["messages_out"] == PINGS
    assert live["nodes"]["world_simulator"]["messages_out"] == 3 * PINGS
    assert all(live["topics"][name]["messages"] == PINGS for name in OUTPUTS)

    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", tmp_path / "replay.json")
    assert done.returncode == 0, done.stdout
    replayed = report_of(tmp_path / "replay.json")
    assert all(replayed["comparison"][name].startswith("identical: ") for name in OUTPUTS)
    assert digests(replayed) == {name: digests(live)[name] for name in digests(replayed)}

    offline = run_offline_active_chain(replace(load_scenario("active"), duration=ACTIVE_DURATION))
    recorded = list(position_tracks_of(read_bag(bag), TRACKS))
    for found, update in zip(recorded, offline.updates, strict=True):
        assert found.stamp == update.tracks.stamp
        assert np.array_equal(found.id, update.tracks.id)
        assert np.array_equal(found.state, update.tracks.state)
        assert np.array_equal(found.covariance, update.tracks.covariance)
