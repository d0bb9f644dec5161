"""A recorded array through the graph: WAV file, bag, replay; the same tracks as offline."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from sonar_tracking.bags.storage.bag_records import bearing_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.evaluation.studies.room_array.responses import (
    read_room_responses,
    received_signal,
    write_recording,
)
from sonar_tracking.evaluation.studies.room_array.study import BANDWIDTH, node_parameters, track_bag
from tests.recorded_data import recorded_data
from tests.system.command_line import refused, report_of, run_command

MEASURED = "ula32_room_responses/rir_sources_1_2_3_4_5_8_9.npz"
PAIR = (8, 9)


@pytest.mark.data
def test_two_sources_of_a_measured_array_are_tracked_by_the_graph(tmp_path: Path) -> None:
    room = read_room_responses(recorded_data(MEASURED))
    generator = np.random.default_rng(3)
    signals = [received_signal(room, source, 5000.0, generator) for source in PAIR]
    wav, geometry, truth = write_recording(room, PAIR, signals, BANDWIDTH, generator, tmp_path)
    parameters = tmp_path / "parameters.yaml"
    parameters.write_text(yaml.safe_dump(node_parameters(len(PAIR))))
    bag, recorded, json = tmp_path / "bag", tmp_path / "recorded", tmp_path / "report.json"
    imported = run_command(
        tmp_path, "import", "wav", wav, "--geometry", geometry, "--frequency", 5000,
        "--bandwidth", BANDWIDTH, "--output", bag, "--truth", truth, "--parameters", parameters,
    )  # fmt: skip
    assert imported.returncode == 0, imported.stdout
    assert "8 elements" in imported.stdout
    done = run_command(
        tmp_path, "replay", bag, "--rate", "max", "--record", recorded, "--json", json
    )
    assert done.returncode == 0, done.stdout
    score = report_of(json)["score"]
    assert score["median_error_deg"] < 2.0
    assert score["lost_tracks"] == 0 and score["identity_swaps"] == 0
    offline = track_bag(read_bag(bag)).tracks
    through_graph = list(bearing_tracks_of(read_bag(recorded), "/passive/bearing_tracks"))
    assert [tracks.stamp for tracks in through_graph] == [tracks.stamp for tracks in offline]
    for ours, theirs in zip(offline, through_graph, strict=True):
        np.testing.assert_array_equal(ours.id, theirs.id)
        np.testing.assert_array_equal(ours.arrival_angle, theirs.arrival_angle)
        np.testing.assert_array_equal(ours.covariance, theirs.covariance)


def test_a_request_that_cannot_be_met_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "array.yaml").write_text("n_elements: 8\nspacing: 0.03\n")
    (tmp_path / "array.wav").write_text("no sound")
    arguments = ("--geometry", tmp_path / "array.yaml", "--frequency", 5000)
    words = ("import", "wav", tmp_path / "array.wav", *arguments, "--output", tmp_path / "bag")
    assert "is no audio file" in refused(tmp_path, *words)
    (tmp_path / "wrong.yaml").write_text("bearing_tracker: {metod: ryu}\n")
    said = refused(tmp_path, *words, "--parameters", tmp_path / "wrong.yaml")
    assert "did you mean method" in said
    assert "--data" in refused(tmp_path, "evaluate", "room-array")
