"""``import wav --samples``: recorded hydrophones through the graph, as the simulated ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml
from scipy.io import wavfile

from sonar_tracking.bags.storage.bag_records import frequency_lines_of, position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.offline.offline_sample_chain import run_offline_sample_chain
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.system.command_line import refused, report_of, run_command

SECONDS = 30.0


def test_samples_of_a_wav_give_the_lines_the_simulation_gives(tmp_path: Path) -> None:
    scenario = replace(load_scenario("tonals"), duration=SECONDS)
    offline = run_offline_sample_chain(scenario)
    samples = np.concatenate([block.samples.data for block in offline.blocks])
    wavfile.write(tmp_path / "a.wav", 1000, samples.astype(np.float32))
    geometry = {"element_x": list(scenario.array.element_x), "mounting_yaw_deg": 180.0}
    (tmp_path / "array.yaml").write_text(yaml.safe_dump(geometry))
    nodes = {name: dict(values) for name, values in scenario.nodes.items() if values}
    (tmp_path / "nodes.yaml").write_text(yaml.safe_dump(nodes))
    (tmp_path / "own.csv").write_text("time_s,east_m,north_m,heading_deg\n0,0,0,0\n100,0,600,0\n")
    done = run_command(
        tmp_path, "import", "wav", tmp_path / "a.wav", "--geometry", tmp_path / "array.yaml",
        "--samples", "--own-ship", tmp_path / "own.csv", "--parameters", tmp_path / "nodes.yaml",
        "--output", tmp_path / "bag",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert "30000 samples of 12 elements in 60 blocks" in done.stdout
    done = run_command(
        tmp_path, "replay", tmp_path / "bag", "--rate", "max", "--record", tmp_path / "recorded",
        "--json", tmp_path / "replay.json",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert report_of(tmp_path / "replay.json")["topics"]["/array/lofar"]["messages"] == 29
    recording = read_bag(tmp_path / "recorded")
    lines = list(frequency_lines_of(recording, "/passive/frequency_lines"))
    for heard, expected in zip(lines, offline.lines, strict=True):
        assert heard.stamp == expected.stamp
        np.testing.assert_array_equal(heard.frequency, expected.frequency)
        np.testing.assert_array_equal(heard.line_id, expected.line_id)
    assert len(lines[-2].line_id) == 3
    positions = list(position_tracks_of(recording, "/passive/tracks"))
    for tracks, other in zip(positions, offline.positions, strict=True):
        np.testing.assert_array_equal(tracks.id, other.id)
        np.testing.assert_allclose(tracks.state, other.state, rtol=1e-6, atol=1e-3)
    assert len(positions[-1].id) == 2  # the two sides of the array


def test_a_request_that_cannot_be_met_is_one_sentence(tmp_path: Path) -> None:
    wavfile.write(tmp_path / "a.wav", 1000, np.zeros((3000, 4), np.float32))
    (tmp_path / "array.yaml").write_text("n_elements: 4\nspacing: 1.0\n")
    (tmp_path / "own.csv").write_text("time_s,east_m,north_m\n0,0,0\n")
    common = ("import", "wav", tmp_path / "a.wav", "--geometry", tmp_path / "array.yaml",
              "--output", tmp_path / "bag")  # fmt: skip
    for options, reason in (
        ((), "Give --frequency"),
        (("--samples",), "give --frequency, or"),
        (("--frequency", 300, "--own-ship", tmp_path / "own.csv"), "goes with --samples"),
        (("--samples", "--frequency", 700), "half the sample rate"),
    ):
        assert reason in " ".join(refused(tmp_path, *common, *options).split())
    assert not (tmp_path / "bag").exists()
