"""Protects that runs computed together are those computed alone, to the last bit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.evaluation.offline.known_world import KnownWorld
from sonar_tracking.evaluation.offline.offline_sample_chain import (
    positions_of_samples,
    run_offline_sample_chain,
)
from sonar_tracking.evaluation.offline.offline_tma_chain import (
    run_offline_tma_chain,
    run_offline_tma_chains,
)
from sonar_tracking.evaluation.offline.place_tracks import (
    place_tracks,
    place_tracks_together,
)
from sonar_tracking.evaluation.studies.track_fusion import conditions
from sonar_tracking.simulation.scenarios.scenario import NodeParameters, Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario


def seeded(name: str, duration: float) -> list[Scenario]:
    """Return two short runs of a scenario."""
    scenario = replace(load_scenario(name), duration=duration)
    return [replace(scenario, seed=seed) for seed in (4, 5)]


def columns(records: Sequence[Any]) -> list[dict[str, Any]]:
    return [asdict(record) for record in records]


def differ(first: Sequence[Any], second: Sequence[Any]) -> bool:
    try:
        np.testing.assert_equal(columns(first), columns(second))
    except AssertionError:
        return True
    return False


@pytest.mark.parametrize("name", ["tma", "cross_fix"])
def test_bearings_of_several_runs_become_positions_as_those_of_each(name: str) -> None:
    scenarios = seeded(name, 30.0)
    together = run_offline_tma_chains(scenarios)
    for scenario, run in zip(scenarios, together, strict=True):
        alone = run_offline_tma_chain(scenario)
        assert any(len(tracks.id) for tracks in alone.tracks)
        assert not differ(run.tracks, alone.tracks)
    assert differ(together[0].tracks, together[1].tracks)


def test_samples_of_several_runs_become_positions_as_those_of_each() -> None:
    scenarios = seeded("tonals", 40.0)
    together = positions_of_samples(scenarios)
    for scenario, run in zip(scenarios, together, strict=True):
        alone = run_offline_sample_chain(scenario)
        heard = [one for frame in run.frames for one in frame.bearings]
        lines = [one for frame in run.frames for one in frame.lines]
        assert any(len(tracks.id) for tracks in alone.positions)
        assert not differ(heard, alone.bearings) and not differ(lines, alone.lines)
        assert not differ(run.positions, alone.positions)
        assert not differ(run.truth, [block.truth_tracks for block in alone.blocks])
    assert differ(together[0].positions, together[1].positions)


@pytest.mark.parametrize("method", ["integrated", "roi_clustering"])
def test_places_of_several_runs_hear_what_those_of_each_hear(
    monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    monkeypatch.setattr(conditions, "DURATION", 80.0)
    scene = conditions.CONDITIONS["clutter"]
    runs = [scene.scenario(seed) for seed in np.random.SeedSequence(3).spawn(2)]
    chosen: NodeParameters = {"hpda_tracker": {"method": method}}
    scenarios = [replace(run, nodes={**run.nodes, **chosen}) for run in runs]
    worlds = [KnownWorld(scenario) for scenario in scenarios]
    together = place_tracks_together(scenarios, worlds)
    for scenario, world, told in zip(scenarios, worlds, together, strict=True):
        alone = place_tracks(scenario, world)
        assert any(len(tracks["active/tracks"].id) for tracks in alone.active.at.values())
        assert not differ([told], [alone])
    assert differ([together[0]], [together[1]])
