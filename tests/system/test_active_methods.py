"""Every method and gate threshold of the contact tracker: the graph gives the bits of one process.

One recording is replayed through the live node with each; what it publishes is compared with the
same pings tracked offline. Both being equal, live, replayed and offline results are.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario, scenario_to_yaml
from tests.made_once import made_once
from tests.system.command_line import digests, report_of, run_command

TRACKS = "/active/tracks"
PINGS = 25
VARIANTS: dict[str, dict[str, str | float]] = {
    "hpda_kalman": {"method": "hpda_kalman"},
    "hpda_particle": {"method": "hpda_particle", "n_particles": 300},
    "roi_clustering": {"method": "roi_clustering", "n_particles": 300},
    "smc_phd": {"method": "smc_phd", "n_particles": 300},
    "closed form": {"gate_threshold": "closed_form", "search_false_alarm_probability": 0.002},
    "fixed": {"gate_threshold": "fixed", "gate_false_alarm_probability": 0.001},
}


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scenario]:
    """Record the beginning of the scenario ``active``."""
    scenario = dataclasses.replace(load_scenario("active"), duration=10.0 * PINGS)

    def make(folder: Path) -> None:
        file = folder / "scene.yaml"
        file.write_text(scenario_to_yaml(scenario))
        done = run_command(folder, "run", file, "--rate", "max", "--record", folder / "bag")
        assert done.returncode == 0, done.stdout

    return made_once(tmp_path_factory, "active_beginning", make) / "bag", scenario


def parameters_of(variant: str, scenario: Scenario) -> dict[str, Any]:
    """Return the parameters of the tracker: those of the scenario, changed."""
    return dict(scenario.nodes["hpda_tracker"]) | VARIANTS[variant]


@pytest.fixture(scope="session")
def replayed(
    recorded: tuple[Path, Scenario], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Path]:
    """Replay the recording with a variant, once; return the folder of bag and report."""
    bag, scenario = recorded

    def make(variant: str, folder: Path) -> None:
        overrides = folder / "parameters.yaml"
        overrides.write_text(yaml.safe_dump({"hpda_tracker": parameters_of(variant, scenario)}))
        done = run_command(
            folder, "replay", bag, "--rate", "max", "--record", folder / "bag",
            "--parameters", overrides, "--json", folder / "report.json",
        )  # fmt: skip
        # The recording was made with other parameters: replay says that the tracks differ.
        assert "differ" in done.stdout, done.stdout

    return lambda variant: made_once(tmp_path_factory, f"active_{variant}", partial(make, variant))


@pytest.mark.parametrize("variant", VARIANTS)
def test_graph_and_offline_chain_give_the_same_bits(
    variant: str, recorded: tuple[Path, Scenario], replayed: Callable[[str], Path]
) -> None:
    scenario = recorded[1]
    tracks = list(position_tracks_of(read_bag(replayed(variant) / "bag"), TRACKS))
    offline = run_offline_active_chain(
        dataclasses.replace(scenario, nodes={"hpda_tracker": parameters_of(variant, scenario)})
    )
    assert len(tracks) == len(offline.updates) == PINGS
    assert max(len(found) for found in tracks) >= 2
    for found, update in zip(tracks, offline.updates, strict=True):
        for field in dataclasses.fields(found):
            column = getattr(found, field.name)
            if isinstance(column, np.ndarray):
                assert column.tobytes() == getattr(update.tracks, field.name).tobytes(), field.name


def test_a_replay_with_other_parameters_replays_identically(
    replayed: Callable[[str], Path], tmp_path: Path
) -> None:
    folder, json = replayed("closed form"), tmp_path / "second.json"
    done = run_command(tmp_path, "replay", folder / "bag", "--rate", "max", "--json", json)
    assert done.returncode == 0, done.stdout
    first, second = report_of(folder / "report.json"), report_of(json)
    assert TRACKS in digests(second) and "/active/threshold" in digests(second)
    assert digests(second).items() <= digests(first).items()
