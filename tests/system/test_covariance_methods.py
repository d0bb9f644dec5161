"""Trackers that measure in block covariances, through the graph."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_bearing_chain import run_offline_chain
from sonar_tracking.graph.orchestration.run_observer import tracks_from_bytes
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario, scenario_to_yaml
from tests.system.command_line import refused, report_of, run_command

TRACKS = "/passive/bearing_tracks"


def scenario_with(tracker: str, estimator: str, duration: float) -> Scenario:
    """Return the crossing targets, tracked from nothing by a pair of methods."""
    return dataclasses.replace(
        load_scenario("doa_fusion"),
        duration=duration,
        nodes={
            "subspace_estimator": {
                "method": estimator,
                "n_subspaces": 1,
                "covariance_snapshots": 200,
            },
            "bearing_tracker": {"method": tracker},
        },
    )


@pytest.mark.parametrize("method", ["coherent", "joint_map"])
def test_graph_and_offline_chain_give_the_same_bits(tmp_path: Path, method: str) -> None:
    scenario = scenario_with(method, "covariance", 15.1)
    file, bag, json = tmp_path / "scene.yaml", tmp_path / "bag", tmp_path / "report.json"
    file.write_text(scenario_to_yaml(scenario))
    done = run_command(tmp_path, "run", file, "--rate", "max", "--record", bag, "--json", json)
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    assert report["latency_ms"]["algorithmic"] == pytest.approx(0.0)
    assert report["score"]["lost_tracks"] == 0
    assert report["score"]["rmse_deg"] < 1.0
    live = [tracks_from_bytes(message.data) for message in read_bag(bag).messages([TRACKS])]
    offline = run_offline_chain(scenario).tracks
    assert len(live) == len(offline) == 30
    assert len(live[-1].id) == 5
    for ours, theirs in zip(live, offline, strict=True):
        for field in dataclasses.fields(ours):
            column = getattr(ours, field.name)
            if isinstance(column, np.ndarray):
                assert column.tobytes() == getattr(theirs, field.name).tobytes(), field.name


def test_a_pair_that_does_not_fit_is_refused_before_anything_starts(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(scenario_to_yaml(scenario_with("joint_map", "past", 5.0)))
    sentence = " ".join(refused(tmp_path, "run", file, "--rate", "max").split())
    assert "bearing_tracker.method joint_map needs subspace_estimator.method covariance" in sentence
