"""What is decided of a replay before anything is started."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.display.run_display import LineDisplay
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_settings import resolved_settings
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan, resolved
from sonar_tracking.graph.orchestration.topic_record import TopicRecord
from sonar_tracking.graph.verbs.recording_plan import recording_hint
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.graph.verbs.run_replay import opened_bag, plan_replay
from tests.bags.bag_fixtures import (
    SECOND,
    TRACKS,
    open_writer,
    tracks_cdr,
    write_messages,
    write_wrapped_record,
)


def test_an_old_bag_is_rewritten_on_request_only_and_the_reason_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        write_wrapped_record(patch)
        writer = open_writer(tmp_path / "old")
        write_messages(writer, 3)
        writer.close()
    said = io.StringIO()
    display = LineDisplay(Console(file=said, width=1000))
    assert opened_bag(tmp_path / "old", False, display).path == tmp_path / "old"
    assert said.getvalue() == ""
    repaired = opened_bag(tmp_path / "old", True, display)
    assert repaired.path == tmp_path / "old_repaired" and repaired.outdated is None
    assert list(repaired.messages()) == list(read_bag(tmp_path / "old").messages())
    assert "cannot be opened by the stock ROS 2 tools" in said.getvalue()
    assert f"the repaired bag is {tmp_path / 'old_repaired'}" in said.getvalue()


def station_bag(folder: Path) -> Path:
    """Record bearings of two stations and the truth, as somebody else's recorder would."""
    writer = BagWriter(folder / "stations")
    topics = ("/a/passive/bearing_tracks", "/b/passive/bearing_tracks", "/truth/bearing_tracks")
    for topic in topics:
        writer.add_topic(topic, TRACKS, role="output" if "passive" in topic else "truth")
        writer.write(topic, SECOND, tracks_cdr(1))
    writer.add_topic("/silent/truth/bearing_tracks", TRACKS, role="truth")
    writer.close()
    return writer.path


def replay_plan(folder: Path, record: Path | None) -> GraphPlan:
    node = NODES["tma_tracker"]
    listed = {"bearing_topics": ("a/passive/bearing_tracks", "b/passive/bearing_tracks")}
    settings = resolved_settings({node.name: listed}, (node,), "test")
    options = RunOptions(record=record)
    return plan_replay(read_bag(station_bag(folder)), settings, options, folder, None)


def test_truth_is_played_to_no_node_but_the_recorder(tmp_path: Path) -> None:
    plan = replay_plan(tmp_path, None)
    assert {resolved(topic): topic.role.value for topic in plan.offered} == {
        "/a/passive/bearing_tracks": "input",
        "/b/passive/bearing_tracks": "input",
        "/operator/commands": "input",
        "/truth/bearing_tracks": "truth",
    }
    assert plan.consumers()["/truth/bearing_tracks"] == ()


def test_a_recorded_replay_keeps_truth_and_knows_its_inputs(tmp_path: Path) -> None:
    plan = replay_plan(tmp_path, tmp_path / "again")
    assert plan.consumers()["/truth/bearing_tracks"] == ("recorder",)
    recording = RecordingInformation.from_json((tmp_path / "recording.json").read_text(), "test")
    assert recording.topic_roles == {
        "/a/passive/bearing_tracks": "input",
        "/b/passive/bearing_tracks": "input",
        "/operator/commands": "input",
        "/passive/tracks": "output",
        "/passive/station_alignment": "output",
        "/truth/bearing_tracks": "truth",
        "/diagnostics": "display",
    }


def test_the_hint_names_only_inputs_that_hold_messages(tmp_path: Path) -> None:
    topics = replay_plan(tmp_path, None).topics()
    records = {name: TopicRecord(topic.message_type) for name, topic in topics.items()}
    (bag,) = (entry for entry in tmp_path.iterdir() if entry.is_dir())
    assert recording_hint(bag, topics, records) == f"recorded {bag}"
    for name in ("/b/passive/bearing_tracks", "/truth/bearing_tracks"):
        records[name].add(tracks_cdr(1))
    hint = recording_hint(bag, topics, records)
    assert hint.endswith(f"ros2 bag play {bag} --clock --topics /b/passive/bearing_tracks")


def test_what_was_recorded_in_part_does_not_pass_for_recorded(tmp_path: Path) -> None:
    (file,) = station_bag(tmp_path).glob("*.mcap")
    file.write_bytes(file.read_bytes()[:-400])
    hint = recording_hint(file.parent, {}, {})
    assert hint.startswith("this run was recorded in part: ") and "is not whole" in hint
    assert recording_hint(tmp_path / "none", {}, {}).startswith("this run was not recorded: ")


@pytest.mark.parametrize("cutoff", [0.0, -3.0, float("nan"), float("inf")])
def test_a_cutoff_that_is_no_distance_is_refused_before_anything_starts(cutoff: float) -> None:
    with pytest.raises(ConfigurationError, match="give a positive distance"):
        RunOptions(cutoff_m=cutoff).check()
