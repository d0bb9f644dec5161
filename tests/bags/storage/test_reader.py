"""Reading must give all that can be read of any file, and a sentence for the rest."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import pytest
from mcap.writer import CompressionType, Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter

from sonar_tracking.bags.contents.message_definitions import (
    installed_definition,
    installed_typestore,
)
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.repair import repair_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError
from tests.bags.bag_fixtures import (
    CLOCK,
    EPOCH,
    SECOND,
    SNAPSHOTS,
    clock_cdr,
    information,
    open_writer,
    snapshots_cdr,
    write_messages,
)


def whole_bag(path: Path, n_seconds: int = 12) -> list[tuple[str, int, bytes]]:
    writer = open_writer(path)
    written = write_messages(writer, n_seconds)
    writer.close()
    return written


def test_a_round_trip_keeps_bytes_order_and_information(tmp_path: Path) -> None:
    written = whole_bag(tmp_path / "run")
    bag = read_bag(tmp_path / "run")
    assert bag.recovery is None
    assert bag.recording == information()
    # Log order; equal times in the order of writing, which Python's sort keeps.
    expected = sorted(written, key=lambda message: message[1])
    assert [(m.topic, m.log_time, m.data) for m in bag.messages()] == expected
    assert {name: topic.role for name, topic in bag.topics.items()} == {
        "/array/snapshots": "input",
        "/clock": "other",
        "/passive/bearing_tracks": "output",
    }
    assert bag.topics["/array/snapshots"].definition == installed_definition(SNAPSHOTS)
    assert {m.topic for m in bag.messages(["/clock"])} == {"/clock"}


@pytest.mark.slow
def test_truncation_at_any_byte_gives_the_whole_messages_before_it(tmp_path: Path) -> None:
    written = whole_bag(tmp_path / "run", 6)
    data = (tmp_path / "run" / "run_0.mcap").read_bytes()
    offsets = sorted({*range(0, len(data), 61), *range(len(data) - 60, len(data))})
    counts = []
    for offset in offsets:
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(data[:offset])
        try:
            bag = read_bag(cut)
        except ConfigurationError as error:
            assert str(error).endswith(".") and str(cut) in str(error)
            counts.append(0)
            continue
        assert bag.recovery is not None and f"{bag.message_count} messages" in bag.recovery
        recovered = [(m.topic, m.log_time, m.data) for m in bag.messages()]
        assert recovered == sorted(written[: len(recovered)], key=lambda message: message[1])
        counts.append(len(recovered))
    assert counts == sorted(counts)
    assert counts[-1] == len(written)


@pytest.mark.slow
def test_damage_anywhere_never_raises_anything_but_a_sentence(tmp_path: Path) -> None:
    whole_bag(tmp_path / "run", 3)
    data = (tmp_path / "run" / "run_0.mcap").read_bytes()
    generator = random.Random(5)
    for _ in range(300):
        damaged = bytearray(data)
        for _ in range(generator.choice((1, 4, 40))):
            damaged[generator.randrange(len(data))] = generator.randrange(256)
        file = tmp_path / "damaged.mcap"
        file.write_bytes(damaged)
        try:
            for _ in read_bag(file).messages():
                pass
        except ConfigurationError as error:
            assert str(error).endswith(".")


def test_missing_metadata_is_said_and_costs_nothing(tmp_path: Path) -> None:
    written = whole_bag(tmp_path / "run")
    (tmp_path / "run" / "metadata.yaml").unlink()
    bag = read_bag(tmp_path / "run")
    assert bag.message_count == len(written)
    assert bag.recovery is not None and "metadata.yaml is missing" in bag.recovery
    assert bag.recording == information()
    assert read_bag(tmp_path / "run" / "run_0.mcap").recovery is None


def test_repair_makes_a_whole_bag_beside_the_damaged_one(tmp_path: Path) -> None:
    whole_bag(tmp_path / "run")
    file = tmp_path / "run" / "run_0.mcap"
    file.write_bytes(file.read_bytes()[:-3000])
    damaged = read_bag(tmp_path / "run")
    assert damaged.message_count > 20
    repaired = read_bag(repair_bag(tmp_path / "run"))
    assert repaired.recovery is None
    assert repaired.topics == damaged.topics
    assert repaired.recording == damaged.recording
    assert list(repaired.messages()) == list(damaged.messages())
    assert repair_bag(repaired.path) == repaired.path


@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.LZ4])
def test_files_of_the_mcap_writer_are_read(tmp_path: Path, compression: CompressionType) -> None:
    with (tmp_path / "other.mcap").open("wb") as file:
        writer = Writer(file, chunk_size=3000, compression=compression)
        writer.start("ros2")
        schema = writer.register_schema(
            SNAPSHOTS, "ros2msg", installed_definition(SNAPSHOTS).text.encode()
        )
        channel = writer.register_channel("/bow/array/snapshots", "cdr", schema)
        for second in (0, 2, 1, 3):
            writer.add_message(channel, second, snapshots_cdr(second), second)
        writer.finish()
    bag = read_bag(tmp_path / "other.mcap")
    assert bag.recovery is None and bag.recording is None
    assert bag.topics["/bow/array/snapshots"].role == "input"
    assert [m.data for m in bag.messages()] == [snapshots_cdr(s) for s in range(4)]


@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_bags_of_other_recorders_are_read(tmp_path: Path, plugin: StoragePlugin) -> None:
    with RosbagsWriter(tmp_path / "other", version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection(
            "/array/snapshots", SNAPSHOTS, typestore=installed_typestore(SNAPSHOTS)
        )
        for second in range(4):
            writer.write(connection, (EPOCH + second) * SECOND, snapshots_cdr(second))
    bag = read_bag(tmp_path / "other")
    assert bag.recovery is None and bag.recording is None
    assert bag.topics["/array/snapshots"].role == "input"
    assert [m.data for m in bag.messages()] == [snapshots_cdr(s) for s in range(4)]


def test_a_bag_without_sonar_topics_is_refused_with_what_it_holds(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "clocks")
    writer.add_topic("/clock", CLOCK)
    writer.write("/clock", SECOND, clock_cdr(1))
    writer.close()
    with pytest.raises(ConfigurationError, match=r"/clock \(rosgraph_msgs/msg/Clock\)"):
        read_bag(tmp_path / "clocks")


def test_what_is_not_a_bag_is_named(tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    text = tmp_path / "notes.txt"
    text.write_text("no bag")
    lying = tmp_path / "lying.mcap"
    lying.write_text("no bag either")
    hollow = tmp_path / "hollow.mcap"
    hollow.write_bytes(b"")
    base = tmp_path / "lying.db3"
    base.write_text("no database")
    for path, reason in (
        (tmp_path / "absent", "does not exist"),
        (empty, "is not a bag"),
        (text, "is not a bag"),
        (lying, "not an MCAP file"),
        (hollow, "is empty"),
        (base, "cannot be read"),
    ):
        with pytest.raises(ConfigurationError, match=reason) as caught:
            read_bag(path)
        assert str(path) in str(caught.value)


def test_a_bag_without_messages_says_so(tmp_path: Path) -> None:
    open_writer(tmp_path / "run").close()
    bag = read_bag(tmp_path / "run")
    assert bag.message_count == 0 and bag.recovery is None
    BagWriter(tmp_path / "bare").close()
    with pytest.raises(ConfigurationError, match="holds no topics"):
        read_bag(tmp_path / "bare")
    shutil.rmtree(tmp_path / "bare")
