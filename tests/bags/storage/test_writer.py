"""Bags must open in tools that know nothing of this project, and keep bytes as received."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcap.reader import SeekingReader, make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from sonar_tracking.bags.contents.message_definitions import installed_definition
from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError
from tests.bags.bag_fixtures import (
    CLOCK,
    EPOCH,
    SECOND,
    SNAPSHOTS,
    TRACKS,
    information,
    open_writer,
    write_messages,
)

WRITE_UNTIL_KILLED = """
import sys, time
sys.path.insert(0, {root!r})
from pathlib import Path
from tests.bags.bag_fixtures import EPOCH, SECOND, open_writer, snapshots_cdr
writer = open_writer(Path({bag!r}))
while True:
    now = time.monotonic_ns()
    writer.write("/array/snapshots", now, snapshots_cdr(0))
    print(now, flush=True)
    time.sleep(0.01)
"""


def test_rosbags_reads_the_same_bytes_and_quality_of_service(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "run", information())
    writer.add_topic("/tracks", TRACKS, qos=OfferedQuality(20, "reliable", "transient_local"))
    writer.write("/tracks", EPOCH * SECOND, b"\x00\x01\x00\x00any bytes at all")
    writer.close()
    with Reader(tmp_path / "run") as reader:
        ((connection, log_time, data),) = reader.messages()
        assert (connection.topic, log_time) == ("/tracks", EPOCH * SECOND)
        assert data == b"\x00\x01\x00\x00any bytes at all"
        (profile,) = connection.ext.offered_qos_profiles  # type: ignore[union-attr]
        assert (profile.depth, profile.reliability.name, profile.durability.name) == (
            20,
            "RELIABLE",
            "TRANSIENT_LOCAL",
        )
        assert connection.digest == installed_definition(TRACKS).type_hash


def test_rosbags_decodes_with_the_definitions_in_the_bag(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    written = write_messages(writer, 5)
    writer.close()
    with AnyReader([tmp_path / "run"]) as reader:
        assert reader.message_count == len(written)
        for connection, log_time, data in reader.messages():
            message: Any = reader.deserialize(data, connection.msgtype)
            if connection.msgtype == SNAPSHOTS:
                assert message.header.stamp.sec * SECOND == log_time
                assert message.data[0] == message.header.stamp.sec - EPOCH


def test_the_indexed_reader_and_the_ros_decoder_of_mcap_read_the_file(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    written = write_messages(writer, 40)
    writer.close()
    with (tmp_path / "run" / "run_0.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert isinstance(reader, SeekingReader)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == len(written)
        assert reader.get_header().profile == "ros2"
        times = []
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema is not None and schema.encoding == "ros2msg"
            assert channel.message_encoding == "cdr"
            times.append(message.log_time)
            if schema.name == CLOCK:
                assert decoded.clock.sec * SECOND == message.log_time
        assert times == sorted(times) and len(times) == len(written)


def test_each_channel_carries_the_hash_of_the_compiled_type(tmp_path: Path) -> None:
    import json

    compiled = Path(sys.prefix) / "share" / "sonar_tracking_msgs" / "msg" / "ArraySnapshots.json"
    if not compiled.is_file():
        pytest.skip(f"{compiled.name} of the compiled messages is not installed")
    hashes = {
        entry["type_name"]: entry["hash_string"]
        for entry in json.loads(compiled.read_text())["type_hashes"]
    }
    assert installed_definition(SNAPSHOTS).type_hash == hashes[SNAPSHOTS]


def test_metadata_has_the_fields_of_version_nine(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    path = tmp_path / "run" / "metadata.yaml"
    started = yaml.safe_load(path.read_text())["rosbag2_bagfile_information"]
    assert started["message_count"] == 0 and len(started["topics_with_message_count"]) == 3
    written = write_messages(writer, 10)
    writer.close()
    done = yaml.safe_load(path.read_text())["rosbag2_bagfile_information"]
    assert done["version"] == 9
    assert done["storage_identifier"] == "mcap"
    assert done["ros_distro"] == "jazzy"
    assert done["message_count"] == len(written)
    assert done["starting_time"]["nanoseconds_since_epoch"] == EPOCH * SECOND
    assert done["duration"]["nanoseconds"] == 9 * SECOND
    assert done["relative_file_paths"] == ["run_0.mcap"] == [f["path"] for f in done["files"]]
    topic = done["topics_with_message_count"][0]
    assert topic["message_count"] == 10
    assert topic["topic_metadata"]["name"] == "/array/snapshots"
    assert topic["topic_metadata"]["serialization_format"] == "cdr"
    assert topic["topic_metadata"]["type_description_hash"].startswith("RIHS01_")
    assert set(topic["topic_metadata"]["offered_qos_profiles"][0]) == {
        "history",
        "depth",
        "reliability",
        "durability",
        "deadline",
        "lifespan",
        "liveliness",
        "liveliness_lease_duration",
        "avoid_ros_namespace_conventions",
    }
    assert "sonar_tracking.scenario" in done["custom_data"]


@pytest.mark.slow
def test_a_kill_loses_less_than_a_second(tmp_path: Path) -> None:
    script = WRITE_UNTIL_KILLED.format(
        root=str(Path(__file__).parents[2]), bag=str(tmp_path / "killed")
    )
    process = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, env=dict(os.environ), text=True
    )
    assert process.stdout is not None
    first = int(process.stdout.readline())
    lines = [first]
    while lines[-1] - first < 2.2 * SECOND:
        lines.append(int(process.stdout.readline()))
    process.send_signal(signal.SIGKILL)
    lines += [int(line) for line in process.stdout.read().split("\n")[:-1]]
    process.stdout.close()
    process.wait()
    bag = read_bag(tmp_path / "killed")
    assert bag.recovery is not None and str(bag.message_count) in bag.recovery
    assert bag.recording == information()
    recovered = [message.log_time for message in bag.messages()]
    assert recovered == lines[: len(recovered)]
    assert lines[-1] - recovered[-1] <= SECOND


@pytest.mark.slow
def test_messages_of_a_pause_reach_the_file_when_the_flush_is_due(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 3)
    deadline = time.monotonic() + 20.0
    while read_bag(tmp_path / "run").message_count < 8:
        assert time.monotonic() < deadline
        writer.flush_if_due()
    writer.close()


def test_large_messages_pass_unchanged(tmp_path: Path) -> None:
    data = os.urandom(1 << 20) * 16
    writer = open_writer(tmp_path / "run")
    for second in range(2):
        writer.write("/array/snapshots", (EPOCH + second) * SECOND, data)
    writer.close()
    assert [message.data == data for message in read_bag(tmp_path / "run").messages()] == [True] * 2


def test_a_bag_is_not_overwritten(tmp_path: Path) -> None:
    open_writer(tmp_path / "run").close()
    with pytest.raises(ConfigurationError, match="exists already"):
        BagWriter(tmp_path / "run")


def test_an_unknown_type_is_named(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "run")
    with pytest.raises(ConfigurationError, match="other_msgs/msg/Thing is not installed"):
        writer.add_topic("/thing", "other_msgs/msg/Thing")
    writer.close()
