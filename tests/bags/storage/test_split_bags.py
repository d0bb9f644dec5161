"""A bag of several files is one recording: in order of log time, nothing lost, little in memory."""

from __future__ import annotations

import random
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import pytest
import yaml
from mcap.writer import CompressionType, Writer

from sonar_tracking.bags.contents.message_definitions import installed_definition
from sonar_tracking.bags.contents.storage_file import BagMessage, Part
from sonar_tracking.bags.storage.bag_files import natural_order
from sonar_tracking.bags.storage.message_merge import merged_messages
from sonar_tracking.bags.storage.reader import read_bag
from tests.bags.bag_fixtures import (
    SNAPSHOTS,
    TRACKS,
    open_writer,
    snapshots_cdr,
    tracks_cdr,
    write_messages,
)

TOPICS = {"/array/snapshots": SNAPSHOTS, "/passive/bearing_tracks": TRACKS}
Message = tuple[str, int, bytes]


def write_mcap(
    path: Path,
    messages: Sequence[Message],
    chunk_bytes: int = 4000,
    compression: CompressionType = CompressionType.NONE,
    record: dict[str, object] | None = None,
) -> None:
    """Write a file with the mcap package, in the order given; ``chunk_bytes`` 0 = no chunks."""
    with path.open("wb") as stream:
        writer = Writer(
            stream,
            chunk_size=chunk_bytes or 1,
            compression=compression,
            use_chunking=bool(chunk_bytes),
        )
        writer.start("ros2")
        channels = {}
        for topic, type_name in TOPICS.items():
            text = installed_definition(type_name).text.encode()
            schema = writer.register_schema(type_name, "ros2msg", text)
            channels[topic] = writer.register_channel(topic, "cdr", schema)
        for topic, log_time, data in messages:
            writer.add_message(channels[topic], log_time, data, log_time)
        if record is not None:
            writer.add_metadata("rosbag2", {"serialized_metadata": yaml.safe_dump(record)})
        writer.finish()


def write_metadata(folder: Path, names: Sequence[str], message_count: int) -> None:
    """Write the part of ``metadata.yaml`` that matters here."""
    information = {"version": 9, "relative_file_paths": [*names], "message_count": message_count}
    text = yaml.safe_dump({"rosbag2_bagfile_information": information})
    (folder / "metadata.yaml").write_text(text)


def overlapping_files(n_files: int, each: int = 12) -> list[list[Message]]:
    """Return the messages of files that overlap, many of them at the same instants."""
    generator = random.Random(3)
    files = []
    for number in range(n_files):
        times = [10 * number + generator.randrange(40) for _ in range(each)]
        files.append(
            [
                ("/array/snapshots", time, snapshots_cdr(100 * number + place))
                if place % 3
                else ("/passive/bearing_tracks", time, tracks_cdr(100 * number + place))
                for place, time in enumerate(times)
            ]
        )
    return files


def read(path: Path, topics: Collection[str] | None = None) -> list[Message]:
    return [(m.topic, m.log_time, m.data) for m in read_bag(path).messages(topics)]


def in_order(files: Sequence[Sequence[Message]]) -> list[Message]:
    """Return what must be read: by log time; Python's sort keeps the order of recording."""
    return sorted((m for file in files for m in file), key=lambda message: message[1])


@pytest.mark.parametrize("chunk_bytes", [0, 4000])
def test_overlapping_files_are_merged_by_log_time_and_nothing_is_lost(
    tmp_path: Path, chunk_bytes: int
) -> None:
    files = overlapping_files(12)
    for number, messages in enumerate(files):
        write_mcap(tmp_path / f"k_{number}.mcap", messages, chunk_bytes)
    bag = read_bag(tmp_path)
    assert bag.message_count == 12 * 12
    assert read(tmp_path) == in_order(files)
    only = {"/passive/bearing_tracks"}
    assert read(tmp_path, only) == [m for m in in_order(files) if m[0] in only]


def test_the_names_decide_between_equal_log_times_only(tmp_path: Path) -> None:
    files = [[("/array/snapshots", 5, snapshots_cdr(number))] for number in range(11)]
    for number, messages in enumerate(files):
        write_mcap(tmp_path / f"k_{number}.mcap", messages)
    assert read(tmp_path) == in_order(files), "k_2 comes before k_10"
    # Where the bag says the order of its files, names mean nothing.
    order = [*range(5, 11), *range(5)]
    write_metadata(tmp_path, [f"k_{number}.mcap" for number in order], 11)
    assert read(tmp_path) == in_order([files[number] for number in order])


def test_numbers_in_names_count_by_their_size() -> None:
    names = ["k_10.mcap", "k_2.mcap", "k_1_10.mcap", "k_1_9.mcap", "a.mcap", "10.mcap", "9.mcap"]
    assert sorted(names, key=natural_order) == [
        "9.mcap", "10.mcap", "a.mcap", "k_1_9.mcap", "k_1_10.mcap", "k_2.mcap", "k_10.mcap",
    ]  # fmt: skip


@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.ZSTD])
@pytest.mark.parametrize("chunk_bytes", [0, 3000, 1 << 20])
def test_one_file_out_of_order_is_put_in_order_and_ties_keep_their_order(
    tmp_path: Path, compression: CompressionType, chunk_bytes: int
) -> None:
    generator = random.Random(8)
    # More messages than are put in order at once outside of chunks.
    messages = [
        ("/passive/bearing_tracks", generator.randrange(500), tracks_cdr(place))
        for place in range(2500)
    ]
    write_mcap(tmp_path / "k.mcap", messages, chunk_bytes, compression)
    assert read(tmp_path / "k.mcap") == in_order([messages])


def test_a_part_is_opened_when_its_time_has_come_and_let_go_at_its_end() -> None:
    open_now: set[int] = set()
    most_open = 0

    def part(number: int) -> Part:
        def messages(topics: Collection[str]) -> Iterator[BagMessage]:
            nonlocal most_open
            open_now.add(number)
            most_open = max(most_open, len(open_now))
            for step in range(15):
                yield BagMessage("/a", 10 * number + step, b"%d" % number)
            open_now.remove(number)

        return Part(10 * number, 10 * number + 14, frozenset({"/a"}), messages)

    other = Part(0, 0, frozenset({"/b"}), lambda topics: iter([BagMessage("/b", 0, b"")]))
    parts = [other, *(part(number) for number in reversed(range(100)))]
    merged = list(merged_messages(parts, {"/a"}))
    assert [m.log_time for m in merged] == sorted(10 * n + s for n in range(100) for s in range(15))
    assert not open_now and most_open == 2


def test_one_file_of_a_split_bag_is_a_bag_of_its_own(tmp_path: Path) -> None:
    files = overlapping_files(3)
    names = [f"k_{number}.mcap" for number in range(3)]
    for number, messages in enumerate(files):
        # As a recorder that goes on to the next file leaves it, and the last as it is closed.
        total = 36 if number == 2 else 0
        record = {"version": 9, "relative_file_paths": names[: number + 1], "message_count": total}
        record["custom_data"] = {"campaign": "spring"}
        write_mcap(tmp_path / names[number], messages, record=record)
    for number, messages in enumerate(files):
        bag = read_bag(tmp_path / names[number])
        assert bag.recovery is None and bag.custom_data == {"campaign": "spring"}
        assert read(tmp_path / names[number]) == in_order([messages])
    (tmp_path / "k_1.mcap").unlink()
    recovery = read_bag(tmp_path).recovery
    assert recovery is not None
    assert "k_1.mcap is missing" in recovery and "24 of 36 messages" in recovery


def test_missing_and_empty_files_are_named_and_the_others_are_read(tmp_path: Path) -> None:
    files = overlapping_files(3)
    for number in (0, 2):
        write_mcap(tmp_path / f"k_{number}.mcap", files[number])
    (tmp_path / "k_3.mcap").touch()
    write_metadata(tmp_path, [f"k_{number}.mcap" for number in range(4)], 36)
    bag = read_bag(tmp_path)
    assert bag.recovery is not None
    assert "k_1.mcap is missing" in bag.recovery and "k_3.mcap is empty" in bag.recovery
    assert read(tmp_path) == in_order([files[0], files[2]])


def test_a_renamed_file_is_no_missing_one(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 3)
    writer.close()
    (tmp_path / "run" / "run_0.mcap").rename(tmp_path / "run" / "tuesday.mcap")
    assert read_bag(tmp_path / "run").recovery is None
