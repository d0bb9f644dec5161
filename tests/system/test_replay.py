"""``sonar-tracking replay``: a recording gives the same tracks at any speed."""

from __future__ import annotations

import shutil
import signal
import sys
from pathlib import Path

import pytest
import yaml
from rosbags.convert.__main__ import main as convert_bag

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from tests.system.command_line import RunningCommand, digests, refused, report_of, run_command
from tests.system.conftest import RecordedRun

OUTPUTS = ("/array/subspaces", "/passive/bearing_tracks")


@pytest.mark.parametrize("rate", ["10", "max"])
def test_identical_at_any_rate(recorded_run: RecordedRun, tmp_path: Path, rate: str) -> None:
    json = tmp_path / "report.json"
    done = run_command(
        tmp_path, "replay", recorded_run.bag, "--rate", rate, "--record", tmp_path / "again",
        "--json", json,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    assert all(report["comparison"][name].startswith("identical: ") for name in OUTPUTS)
    live = digests(recorded_run.report)
    assert digests(report) == {name: live[name] for name in digests(report)}
    assert {*OUTPUTS, "/array/snapshots", "/truth/bearing_tracks"} <= set(digests(report))
    assert report["score"] == recorded_run.report["score"]
    assert report["nodes"]["subspace_estimator"]["messages_in"] == 141
    # A replay can be recorded, and holds what is needed for the next one.
    again = read_bag(tmp_path / "again")
    assert again.recording is not None and "bearing_tracker" in again.recording.node_parameters
    assert again.topics["/array/snapshots"].message_count == 141
    assert again.topics.keys() == read_bag(recorded_run.bag).topics.keys()


def test_other_parameters_differ_and_are_no_failure(
    recorded_run: RecordedRun, tmp_path: Path
) -> None:
    parameters = tmp_path / "other.yaml"
    parameters.write_text("bearing_tracker: {process_noise_deg2: 0.5}\n")
    json = tmp_path / "report.json"
    done = run_command(
        tmp_path, "replay", recorded_run.bag, "--rate", "max", "--parameters", parameters,
        "--json", json,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    comparison = report_of(json)["comparison"]
    assert comparison["/array/subspaces"].startswith("identical")
    assert comparison["/passive/bearing_tracks"].startswith("different from message")


def test_a_cut_off_bag_is_identical_as_far_as_it_goes(
    recorded_run: RecordedRun, tmp_path: Path
) -> None:
    bag = tmp_path / "cut"
    shutil.copytree(recorded_run.bag, bag)
    (file,) = bag.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    (bag / "metadata.yaml").unlink()
    json = tmp_path / "report.json"
    done = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", json)
    assert done.returncode == 0, done.stdout
    assert "recovered" in done.stdout
    report = report_of(json)
    assert all(phrase.startswith("identical") for phrase in report["comparison"].values())
    assert 50 < report["nodes"]["subspace_estimator"]["messages_in"] < 141


def test_a_foreign_bag_with_names_of_its_own_and_parameters(
    recorded_run: RecordedRun, tmp_path: Path
) -> None:
    foreign = BagWriter(tmp_path / "foreign")
    source = read_bag(recorded_run.bag)
    topic = source.topics["/array/snapshots"]
    foreign.add_topic("/port" + topic.name, topic.type_name)
    for message in source.messages([topic.name]):
        foreign.write("/port" + topic.name, message.log_time, message.data)
    foreign.close()
    done = run_command(tmp_path, "replay", tmp_path / "foreign")
    assert done.returncode == 2
    assert "subspace_estimator, bearing_tracker" in done.stdout
    assert "--namespace /port" in done.stdout
    parameters = tmp_path / "parameters.yaml"
    parameters.write_text(
        "subspace_estimator: {ros__parameters: {period: 0.5}}\nbearing_tracker: {}\n"
    )
    json = tmp_path / "report.json"
    done = run_command(
        tmp_path, "replay", tmp_path / "foreign", "--parameters", parameters, "--rate", "max",
        "--json", json, "--remap", "/port/array/snapshots:=/array/snapshots",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    assert "by the types" not in done.stdout
    assert report["topics"]["/passive/bearing_tracks"]["messages"] > 20
    assert "score" in report and report["score"] == {}


def test_a_bag_converted_to_sqlite3_and_back_replays_identically(
    recorded_run: RecordedRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for source, target, storage in (
        (recorded_run.bag, tmp_path / "base", "sqlite3"),
        (tmp_path / "base", tmp_path / "back", "mcap"),
    ):
        words = ["--src", str(source), "--dst", str(target), "--dst-storage", storage]
        words += ["--compress", "zstd", "--compress-mode", "file"]
        monkeypatch.setattr(sys, "argv", ["rosbags-convert", *words])
        with pytest.raises(SystemExit) as end:
            convert_bag()
        assert end.value.code == 0
    # Converters drop what a recorder has said of its making.
    recording = read_bag(recorded_run.bag).recording
    assert recording is not None
    given = {
        name: {key: value for key, value in values.items() if value != []}
        for name, values in recording.node_parameters.items()
        if not name.endswith("_simulator")
    }
    parameters, json = tmp_path / "parameters.yaml", tmp_path / "report.json"
    parameters.write_text(yaml.safe_dump(given))
    done = run_command(
        tmp_path, "replay", tmp_path / "back", "--parameters", parameters, "--rate", "max",
        "--json", json,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    assert set(report["comparison"]) == set(OUTPUTS)
    assert all(phrase.startswith("identical: ") for phrase in report["comparison"].values())
    assert report["score"] == recorded_run.report["score"]


def test_a_bag_without_inputs_is_refused(recorded_run: RecordedRun, tmp_path: Path) -> None:
    source = read_bag(recorded_run.bag)
    topic = source.topics["/passive/bearing_tracks"]
    writer = BagWriter(tmp_path / "tracks_only", source.recording)
    writer.add_topic(topic.name, topic.type_name, role="output")
    for message in source.messages([topic.name]):
        writer.write(topic.name, message.log_time, message.data)
    writer.close()
    assert "array/snapshots" in refused(tmp_path, "replay", tmp_path / "tracks_only")


def test_a_part_is_replayed_and_not_compared(recorded_run: RecordedRun, tmp_path: Path) -> None:
    json = tmp_path / "report.json"
    done = run_command(
        tmp_path, "replay", recorded_run.bag, "--rate", "max", "--json", json,
        "--start-offset", 7, "--duration", 5,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    assert report["nodes"]["subspace_estimator"]["messages_in"] in (49, 50, 51)
    assert report["comparison"] == {}


def test_a_loop_begins_again_until_it_is_interrupted(
    recorded_run: RecordedRun, tmp_path: Path
) -> None:
    running = RunningCommand(
        tmp_path, "replay", recorded_run.bag, "--rate", "max", "--no-display", "--loop",
        "--start-offset", 4,
    )  # fmt: skip
    try:
        running.wait_for_text("everything was reset")
        running.interrupt()
        assert running.wait() == 128 + signal.SIGINT, running.output
    finally:
        running.clean_up()
    assert "ended by the user" in running.output
