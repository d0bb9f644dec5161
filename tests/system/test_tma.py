"""``sonar-tracking run tma``: recorded, replayed and computed offline, all is the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_tma_chain import run_offline_tma_chain
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.system.command_line import digests, report_of, run_command
from tests.system.shown_runs import SECONDS, shown_run

TRACKS = "/passive/tracks"


def record(folder: Path, name: str, duration: float) -> Path:
    """Record a scenario, whose data need not be whole, and return the folder of bag and report."""
    files = ("--record", folder / "bag", "--json", folder / "run.json")
    done = run_command(folder, "run", name, "--duration", duration, "--rate", "max", *files)
    assert done.returncode == 0, done.stdout
    return folder


@pytest.mark.parametrize(("name", "duration"), [("tma", 540.0), ("cross_fix", 240.0)])
def test_a_scenario_of_bearings_and_lines_runs_and_replays_identically(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, name: str, duration: float
) -> None:
    shown = SECONDS.get(name) == duration
    folder = shown_run(tmp_path_factory, name) if shown else record(tmp_path, name, duration)
    bag, live = folder / "bag", report_of(folder / "run.json")

    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", tmp_path / "replay.json")
    assert done.returncode == 0, done.stdout
    replayed = report_of(tmp_path / "replay.json")
    assert replayed["comparison"][TRACKS].startswith("identical: ")
    assert digests(replayed) == {topic: digests(live)[topic] for topic in digests(replayed)}

    offline = run_offline_tma_chain(replace(load_scenario(name), duration=duration))
    recorded = list(position_tracks_of(read_bag(bag), TRACKS))
    for found, expected in zip(recorded, offline.tracks, strict=True):
        assert (found.stamp, found.next_stamp) == (expected.stamp, expected.next_stamp)
        assert np.array_equal(found.id, expected.id)
        assert np.array_equal(found.state, expected.state)
        assert np.array_equal(found.covariance, expected.covariance)

    score = live["score"]["positions"][TRACKS]
    assert score["targets"] == 3
    assert score["targets_never_held"] == 0
    # Of the rows within 200 m; the fewer there are beyond, the larger is the RMSE of the others.
    assert score["median_error_m"] < 100.0 and score["far_share"] < 0.25
