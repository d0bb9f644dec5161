"""Every method and gate threshold of the contact tracker: the graph gives the bits of one process.

One recording is replayed through the live node with each; what it publishes is compared with the
same pings tracked offline. Both being equal, live, replayed and offline results are.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
import yaml

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario, scenario_to_yaml
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
    "hpda_kalman, closed form": {"method": "hpda_kalman", "gate_threshold": "closed_form"},
}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scenario]:
    """Record the beginning of the scenario ``active``."""
    folder = tmp_path_factory.mktemp("recorded")
    scenario = dataclasses.replace(load_scenario("active"), duration=10.0 * PINGS)
    file, bag = folder / "scene.yaml", folder / "bag"
    file.write_text(scenario_to_yaml(scenario))
    done = run_command(folder, "run", file, "--rate", "max", "--record", bag)
    assert done.returncode == 0, done.stdout
    return bag, scenario


@pytest.mark.parametrize("variant", VARIANTS)
def test_graph_and_offline_chain_give_the_same_bits(
    variant: str, recorded: tuple[Path, Scenario], tmp_path: Path
) -> None:
    bag, scenario = recorded
    parameters = dict(scenario.nodes["hpda_tracker"]) | VARIANTS[variant]
    overrides, again = tmp_path / "parameters.yaml", tmp_path / "again"
    overrides.write_text(yaml.safe_dump({"hpda_tracker": parameters}))
    done = run_command(
        tmp_path, "replay", bag, "--rate", "max", "--record", again, "--parameters", overrides
    )
    # The recording was made with other parameters: replay says that the tracks differ.
    assert "differ" in done.stdout, done.stdout
    replayed = list(position_tracks_of(read_bag(again), TRACKS))
    offline = run_offline_active_chain(
        dataclasses.replace(scenario, nodes={"hpda_tracker": parameters})
    )
    assert len(replayed) == len(offline.updates) == PINGS
    assert max(len(tracks) for tracks in replayed) >= 2
    for found, update in zip(replayed, offline.updates, strict=True):
        for field in dataclasses.fields(found):
            column = getattr(found, field.name)
            if isinstance(column, np.ndarray):
                assert column.tobytes() == getattr(update.tracks, field.name).tobytes(), field.name


def test_a_replay_with_other_parameters_replays_identically(
    recorded: tuple[Path, Scenario], tmp_path: Path
) -> None:
    bag, scenario = recorded
    parameters = dict(scenario.nodes["hpda_tracker"]) | VARIANTS["hpda_kalman, closed form"]
    overrides, again = tmp_path / "parameters.yaml", tmp_path / "again"
    overrides.write_text(yaml.safe_dump({"hpda_tracker": parameters}))
    run_command(
        tmp_path, "replay", bag, "--rate", "max", "--record", again,
        "--parameters", overrides, "--json", tmp_path / "first.json",
    )  # fmt: skip
    done = run_command(
        tmp_path, "replay", again, "--rate", "max", "--json", tmp_path / "second.json"
    )
    assert done.returncode == 0, done.stdout
    first, second = report_of(tmp_path / "first.json"), report_of(tmp_path / "second.json")
    assert TRACKS in digests(second) and "/active/threshold" in digests(second)
    assert digests(second).items() <= digests(first).items()
