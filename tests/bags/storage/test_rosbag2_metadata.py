"""What a bag says of itself must be where rosbag2 looks for it, in the types rosbag2 asks for.

The rules are those of rosbag2 of ROS 2 Jazzy, metadata version 9: ``metadata.yaml`` has the mapping
below ``rosbag2_bagfile_information``, the record in the MCAP file has it bare, and a channel has
the list of its profiles as YAML.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter

from sonar_tracking.bags.contents.bag_information import WRAPPING_KEY, information_from_text
from sonar_tracking.bags.contents.message_definitions import (
    installed_definition,
    installed_typestore,
)
from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.repair import repair_bag
from sonar_tracking.bags.storage.writer import BagWriter
from tests.bags.bag_fixtures import (
    EPOCH,
    SECOND,
    SNAPSHOTS,
    TRACKS,
    information,
    open_writer,
    snapshots_cdr,
    tracks_cdr,
    write_messages,
    write_wrapped_record,
)

READS_AS_ROSBAG2 = r"""
// Asks yaml-cpp for every field in the type in which rosbag2 asks for it; any other type throws.
#include <cstdint>
#include <iostream>
#include <yaml-cpp/yaml.h>
using Text = std::string;
void profiles(const YAML::Node & list) {
  if (!list.IsSequence()) throw std::runtime_error("the profiles are no list");
  for (const auto & p : list) {
    int number;
    if (YAML::convert<int>::decode(p["history"], number)) throw std::runtime_error("old profile");
    std::cout << p["history"].as<Text>() << ' ' << p["depth"].as<int>();
    for (auto name : {"reliability", "durability", "liveliness"})
      std::cout << ' ' << p[name].as<Text>();
    for (auto name : {"deadline", "lifespan", "liveliness_lease_duration"})
      std::cout << ' ' << p[name]["sec"].as<uint64_t>() << ' ' << p[name]["nsec"].as<uint64_t>();
    std::cout << ' ' << p["avoid_ros_namespace_conventions"].as<bool>() << '\n';
  }
}
int main(int, char ** argument) {
  YAML::Node node = YAML::LoadFile(argument[2]);
  if (argument[1] == Text("profiles")) { profiles(node); return 0; }
  if (argument[1] == Text("file")) node.reset(node["rosbag2_bagfile_information"]);
  std::cout << node["version"].as<int>() << ' ' << node["storage_identifier"].as<Text>() << ' '
            << node["duration"]["nanoseconds"].as<uint64_t>() << ' '
            << node["starting_time"]["nanoseconds_since_epoch"].as<uint64_t>() << ' '
            << node["message_count"].as<uint64_t>() << " [" << node["compression_format"].as<Text>()
            << node["compression_mode"].as<Text>() << "] " << node["ros_distro"].as<Text>() << '\n';
  for (const auto & name : node["relative_file_paths"].as<std::vector<Text>>())
    std::cout << name << '\n';
  for (const auto & file : node["files"])
    std::cout << file["path"].as<Text>() << ' ' << file["duration"]["nanoseconds"].as<uint64_t>()
              << ' ' << file["starting_time"]["nanoseconds_since_epoch"].as<uint64_t>() << ' '
              << file["message_count"].as<uint64_t>() << '\n';
  for (const auto & entry : node["topics_with_message_count"]) {
    const auto topic = entry["topic_metadata"];
    for (auto name : {"name", "type", "serialization_format", "type_description_hash"})
      std::cout << topic[name].as<Text>() << ' ';
    std::cout << entry["message_count"].as<uint64_t>() << '\n';
    profiles(topic["offered_qos_profiles"]);
  }
  for (const auto & item : node["custom_data"])
    std::cout << item.first.as<Text>() << '=' << item.second.as<Text>() << '\n';
}
"""

SYSTEM = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"}
"""Compiler and program use the libraries of the system, not those of the ROS wheels."""

FOREVER = "9223372036 854775807"
FOREIGN = {"somebody.else": "Größe: 3\nnext line, 'quoted' \"twice\" \U0001f600 # no comment"}


def small_bag(path: Path) -> list[tuple[str, int, bytes]]:
    """Write two topics of different quality of service; return the messages."""
    writer = BagWriter(path, information(), FOREIGN)
    writer.add_topic("/array/snapshots", SNAPSHOTS, role="input")
    latched = OfferedQuality(7, "best_effort", "transient_local")
    writer.add_topic("/passive/bearing_tracks", TRACKS, role="output", qos=latched)
    messages = [
        ("/array/snapshots", EPOCH * SECOND, snapshots_cdr(0)),
        ("/passive/bearing_tracks", (EPOCH + 1) * SECOND, tracks_cdr(1)),
        ("/array/snapshots", (EPOCH + 2) * SECOND, snapshots_cdr(2)),
    ]
    for message in messages:
        writer.write(*message)
    writer.close()
    return messages


def record_of(file: Path) -> str:
    """Return the text of the metadata record of an MCAP file, read by the mcap package."""
    with file.open("rb") as stream:
        (record,) = [r for r in make_reader(stream).iter_metadata() if r.name == "rosbag2"]
    return record.metadata["serialized_metadata"]


def profiles_of(file: Path) -> dict[str, str]:
    """Return what the channels of an MCAP file say of their quality of service."""
    with file.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return {c.topic: c.metadata["offered_qos_profiles"] for c in summary.channels.values()}


@pytest.fixture(scope="module")
def yaml_cpp(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a program that reads as rosbag2 does."""
    compiler = shutil.which("c++")
    if compiler is None:
        pytest.skip("there is no C++ compiler: install g++ to read bags with yaml-cpp")
    folder = tmp_path_factory.mktemp("yaml_cpp")
    (folder / "reads.cpp").write_text(READS_AS_ROSBAG2)
    command = [compiler, "-std=c++17", str(folder / "reads.cpp"), "-o", str(folder / "reads")]
    done = subprocess.run(
        [*command, "-lyaml-cpp"], env=SYSTEM, capture_output=True, text=True, check=False
    )
    if "yaml-cpp/yaml.h" in done.stderr:
        pytest.skip("yaml-cpp is not there: install libyaml-cpp-dev to read bags as rosbag2 does")
    assert done.returncode == 0, done.stderr
    return folder / "reads"


def read_by(program: Path, kind: str, text: str) -> str:
    """Return what the program reads from a text."""
    file = program.parent / f"{kind}.yaml"
    file.write_text(text, encoding="utf-8")
    done = subprocess.run(
        [program, kind, file], env=SYSTEM, capture_output=True, check=False, encoding="utf-8"
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def expected_reading() -> str:
    tracks, snapshots = (installed_definition(name).type_hash for name in (TRACKS, SNAPSHOTS))
    return (
        f"9 mcap {2 * SECOND} {EPOCH * SECOND} 3 [] jazzy\n"
        "run_0.mcap\n"
        f"run_0.mcap {2 * SECOND} {EPOCH * SECOND} 3\n"
        f"/array/snapshots {SNAPSHOTS} cdr {snapshots} 2\n"
        f"keep_last 10 reliable volatile automatic {FOREVER} {FOREVER} {FOREVER} 0\n"
        f"/passive/bearing_tracks {TRACKS} cdr {tracks} 1\n"
        f"keep_last 7 best_effort transient_local automatic {FOREVER} {FOREVER} {FOREVER} 0\n"
        f"somebody.else={FOREIGN['somebody.else']}\n"
        f"sonar_tracking.scenario={information().to_json()}\n"
    )


def test_the_record_has_the_fields_at_the_top_as_other_writers_have_them(tmp_path: Path) -> None:
    small_bag(tmp_path / "run")
    with RosbagsWriter(tmp_path / "other", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(
            "/array/snapshots", SNAPSHOTS, typestore=installed_typestore(SNAPSHOTS)
        )
        writer.write(connection, SECOND, snapshots_cdr(0))
    ours = yaml.safe_load(record_of(tmp_path / "run" / "run_0.mcap"))
    theirs = yaml.safe_load(record_of(tmp_path / "other" / "other.mcap"))
    assert set(ours) == set(theirs)
    assert ours["version"] == theirs["version"] == 9
    in_file = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())
    assert in_file == {WRAPPING_KEY: ours}


@pytest.mark.slow
def test_yaml_cpp_reads_record_and_file_as_rosbag2_asks_for_them(
    tmp_path: Path, yaml_cpp: Path
) -> None:
    small_bag(tmp_path / "run")
    record = record_of(tmp_path / "run" / "run_0.mcap")
    assert read_by(yaml_cpp, "record", record) == expected_reading()
    file = (tmp_path / "run" / "metadata.yaml").read_text(encoding="utf-8")
    assert read_by(yaml_cpp, "file", file) == expected_reading()
    profiles = profiles_of(tmp_path / "run" / "run_0.mcap")
    lines = re.findall(r"keep_last.*\n", expected_reading())
    assert [read_by(yaml_cpp, "profiles", profiles[t]) for t in sorted(profiles)] == lines


def test_yaml_cpp_reads_a_bag_that_is_being_written(tmp_path: Path, yaml_cpp: Path) -> None:
    writer = BagWriter(tmp_path / "run")
    text = (tmp_path / "run" / "metadata.yaml").read_text(encoding="utf-8")
    writer.close()
    assert read_by(yaml_cpp, "file", text).startswith("9 mcap 0 0 0 [] jazzy\n")


def test_the_record_serves_where_metadata_yaml_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("bare", "wrapped"):
        if name == "wrapped":
            write_wrapped_record(monkeypatch)
        written = small_bag(tmp_path / name)
        (tmp_path / name / "metadata.yaml").unlink()
        bag = read_bag(tmp_path / name)
        assert bag.message_count == len(written)
        assert bag.custom_data["somebody.else"] == FOREIGN["somebody.else"]
        assert bag.recording == information()
        alone = read_bag(tmp_path / name / f"{name}_0.mcap")
        assert alone.recovery is None and alone.custom_data == bag.custom_data


def test_messages_that_the_record_counts_and_the_file_lacks_are_missed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "sonar_tracking.bags.storage.writer.metadata_record_text",
        lambda mapping: yaml.safe_dump({**mapping, "message_count": 5}),
    )
    small_bag(tmp_path / "run")
    bag = read_bag(tmp_path / "run" / "run_0.mcap")
    assert bag.recovery is not None
    assert "speaks of 5 messages" in bag.recovery and "3 of 5 messages" in bag.recovery
    assert read_bag(tmp_path / "run").recovery is None, "metadata.yaml counts more than the record"


def test_an_old_bag_is_read_without_a_word_and_rewritten_on_request(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        write_wrapped_record(patch)
        written = small_bag(tmp_path / "old")
    old = read_bag(tmp_path / "old")
    assert old.recovery is None and old.recording == information()
    assert old.outdated is not None and WRAPPING_KEY in old.outdated
    assert str(tmp_path / "old") in old.outdated and old.outdated.endswith(".")
    repaired = read_bag(repair_bag(tmp_path / "old"))
    assert repaired.path == tmp_path / "old_repaired"
    assert repaired.outdated is None and repaired.recovery is None
    assert repaired.topics == old.topics
    assert repaired.custom_data == old.custom_data
    assert [(m.topic, m.log_time, m.data) for m in repaired.messages()] == written
    assert "version" in yaml.safe_load(record_of(repaired.path / "old_repaired_0.mcap"))
    assert repair_bag(repaired.path) == repaired.path


def test_a_bag_of_today_is_not_outdated(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 3)
    writer.close()
    assert read_bag(tmp_path / "run").outdated is None


@pytest.mark.parametrize(
    "text",
    ["", "[1, 2]", "a: b: c", "rosbag2_bagfile_information: 3", "{", "\x00"],
)
def test_what_is_no_mapping_says_nothing(text: str) -> None:
    assert information_from_text(text) is None


def test_fields_of_other_types_count_as_not_stated() -> None:
    found = information_from_text("{message_count: many, relative_file_paths: 3, custom_data: []}")
    assert found is not None
    assert (found.message_count, found.file_names, found.custom_data) == (None, (), {})
    old = information_from_text("{version: 3, relative_file_paths: [bag/bag_0.db3]}")
    assert old is not None and old.file_names == ("bag_0.db3",)
