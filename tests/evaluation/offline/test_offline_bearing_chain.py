"""The chain in one process: it tracks, is reproducible, and takes its parameters from the nodes."""

import dataclasses

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.evaluation.offline.offline_bearing_chain import OfflineRun, run_offline_chain
from sonar_tracking.simulation.scenarios.scenario import NodeParameters, Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
)


def small_scenario() -> Scenario:
    return scenario_from_mapping(
        {
            "start": -1.0,
            "duration": 16.1,
            "seed": 5,
            "array": {"n_elements": 10},
            "targets": [
                {"level_db": 5.0, "motion": {"kind": "linear", "offset_deg": -30.0}},
                {"level_db": 5.0, "motion": {"kind": "linear", "offset_deg": 20.0, "rate_deg": 1}},
            ],
            "nodes": {"recorder": {"anything": 1}, "bearing_tracker": {"flow_depth": 10}},
        },
        "test",
    )


@pytest.fixture(scope="module")
def run() -> OfflineRun:
    return run_offline_chain(small_scenario())


def test_two_track_lists_a_second_and_one_truth_a_block(run: OfflineRun) -> None:
    scenario = small_scenario()
    stamps = [tracks.stamp for tracks in run.tracks]
    assert [stamp % 500_000_000 for stamp in stamps] == [0] * len(stamps)
    assert stamps == list(range(stamps[0], stamps[-1] + 1, 500_000_000))
    assert [truth.stamp for truth in run.truth][:2] == [scenario.stamp(-1.0), scenario.stamp(-0.9)]


def test_targets_are_found_and_held(run: OfflineRun) -> None:
    """Separated sources at 5 dB: both found by themselves, within the beam, none false."""
    score = run.score()
    assert score.targets == 2
    assert score.rmse_deg < 0.5
    identities = score.identities
    assert identities.targets_never_held == identities.lost_tracks == identities.false_tracks == 0
    assert identities.identity_swaps == 0
    assert identities.confirmation_delay <= 7.0


def test_same_scenario_gives_the_same_bits(run: OfflineRun) -> None:
    again = run_offline_chain(small_scenario())
    for first, second in zip(run.tracks, again.tracks, strict=True):
        for field in dataclasses.fields(first):
            np.testing.assert_equal(getattr(first, field.name), getattr(second, field.name))


def test_parameter_out_of_range_is_named() -> None:
    nodes: NodeParameters = {"subspace_estimator": {"forgetting_factor": 2.0}}
    scenario = dataclasses.replace(small_scenario(), nodes=nodes)
    with pytest.raises(ConfigurationError, match=r"subspace_estimator\.forgetting_factor is 2\.0"):
        run_offline_chain(scenario)


def test_more_sources_than_elements_are_refused() -> None:
    nodes: NodeParameters = {"subspace_estimator": {"source_count": 10}}
    scenario = dataclasses.replace(small_scenario(), nodes=nodes)
    with pytest.raises(InputError, match="source_count"):
        run_offline_chain(scenario)


def test_ships_whose_bearings_cross_keep_their_names() -> None:
    """Four ships, own ship alters course, one ship is silent for a while: four tracks, no more."""
    run = run_offline_chain(load_scenario("crossing_targets"))
    identities = run.score().identities
    assert identities.lasting_identity_swaps == identities.false_tracks == 0
    assert identities.lost_tracks == identities.targets_never_held == 0
    assert identities.smallest_continuity > 0.95
    assert run.score().rmse_deg < 0.2
